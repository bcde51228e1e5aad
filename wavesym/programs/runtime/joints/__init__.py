"""Parameters at run time of chains that are written out: a march with rings whose joints are functions of them."""
