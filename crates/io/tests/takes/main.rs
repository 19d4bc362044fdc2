//! Takes: their three forms, and what is refused.

mod forms;
mod refusals;
mod sample;
mod schema;
