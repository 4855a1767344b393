//! Faults planted in maps are found with their number, place and share; sound maps have none; differences are known.

mod banding;
mod census;
mod clean;
mod diff;
mod green;
mod repair;
mod seams;
mod support;
