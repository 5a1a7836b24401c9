"""The tables of Pesce et al. 2019."""
