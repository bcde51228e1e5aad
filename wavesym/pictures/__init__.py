"""Results -> pictures: histories, the chart, the report."""
