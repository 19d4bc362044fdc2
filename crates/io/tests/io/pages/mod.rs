//! The pages: what they hold, and what a browser makes of them.

mod browser;
mod reports;
