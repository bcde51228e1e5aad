"""What waves gain, as exponentials times powers with exact coefficients: tables, their cost, what arrives of them."""
