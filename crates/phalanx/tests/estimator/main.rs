//! A small estimator: trained, stored, asked.

mod desk;
mod estimating;
mod invariance;
mod model_file;
mod photographs;
mod refusals;
mod training;
mod working_size;
