"""The perception course: seeded roads full of obstacles, and how well the estimator places them."""
