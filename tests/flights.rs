//! Whole flights of the true or measured state, and what they must reach.

mod beyond_the_model;
mod hysteresis;
mod paper;
mod pilots_table;
mod progress;
mod reality;
mod recovery;
mod steady_circle;
mod touchdown;
mod trajectory_files;
mod tuned;
mod vibration;
