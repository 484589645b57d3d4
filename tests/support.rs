//! What several suites share.

pub mod adversary_search;
pub mod binary;
pub mod body;
pub mod extended;
pub mod oracle;
pub mod random;
