//! A pilot flown from outside: every mode, request, refusal and failure, with a vehicle around it.

mod arming;
mod bench;
mod lies;
mod missions;
mod modes;
mod numbers;
mod policies;
mod refusals;
mod requests;
mod streams;
mod support;
