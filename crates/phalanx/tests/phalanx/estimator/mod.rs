//! A small estimator: trained, stored, asked.

mod damage;
mod desk;
mod estimating;
mod few;
mod hypotheses;
mod invariance;
mod learnt_metric;
mod model_file;
mod network;
mod photographs;
mod refusals;
mod roads;
mod shards;
mod subsets;
mod training;
mod working_size;
