//! Sparse Bayesian and kernel regression for vector-valued targets
