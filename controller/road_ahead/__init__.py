"""Road reference of the predictive controllers: preview, its alignment, and wheelbase preview."""
