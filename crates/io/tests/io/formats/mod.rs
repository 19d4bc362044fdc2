//! Takes: their three forms, what is refused, and the files of other tools.

mod exports;
mod forms;
mod refusals;
mod schema;
mod strategies;
