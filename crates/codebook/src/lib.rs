//! K-means with the chi-squared statistic, and soft voting into its centres
