//! The sampled loop analysis against models that share no code with it.

mod common;
mod flown;
mod margins;
mod nonlinear;
mod oracle;
mod table_one;
