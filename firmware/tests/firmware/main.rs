//! The tasks as the boards run them, under a simulated clock, with the `mavlink` crate as the other end of the line.

#![expect(deprecated, reason = "PING's fields are, and clients still send it")]

mod arming;
mod bench_link;
mod boards;
mod card;
mod card_cuts;
mod card_link;
mod control;
mod crtp;
mod embedded;
mod guards;
mod hil_answers;
mod hil_lines;
mod hil_samples;
mod hil_takeover;
mod imu;
mod imu_calibration;
mod imu_flow;
mod journal;
mod last_words;
mod link_commands;
mod link_crowd;
mod link_explained;
mod link_frames;
mod link_messages;
mod link_missions;
mod link_parameters;
mod link_pose_times;
mod link_poses;
mod link_questions;
mod link_setpoints;
mod link_signing;
mod link_tasks;
mod link_telemetry;
mod parameters;
mod port;
mod radio;
mod recorder;
mod repeat;
mod restart;
mod status;
mod support;
mod syslink;
mod tuned;
