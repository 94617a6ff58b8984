"""Pages of contact: agreement and costs of the algorithms, the regularisation."""
