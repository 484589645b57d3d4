//! report.html: one file that any browser opens, without a network and without a server.
//!
//! | module | what it holds |
//! |---|---|
//! | [`page`] | the page: a head, sections of blocks, the data, the program |
//! | `text` | text from elsewhere made harmless in HTML and in JSON |
//! | `prose` | sentences, facts, tables with verdicts, listings |
//! | [`track`] | columns over one time axis, as base64 of single-precision numbers |
//! | `recorder` | a track gathered tick by tick; of a long flight the extremes |
//! | [`plot`] | curves over time, and what bounds them |
//! | [`replay`] | vehicles that move in space |
//! | `distribution` | how a quantity is spread over many flights |
//! | `document` | a scenario's own text, section by section |
//! | `flight` | the page that `fly` writes |
//!
//! A page is made of these parts: `fly` fills one from a flight; `campaign` shows distributions and a table of the
//! worst flights. Style and program lie in `host-sim/report/`, as source files of their own, and are built in.
//!
//! The page's Content-Security-Policy names its one style sheet and its one program by their SHA-256 and allows nothing
//! else: no request, and no program that came in with a scenario's text.

pub(crate) mod distribution;
pub(crate) mod document;
pub(crate) mod flight;
pub mod page;
pub mod plot;
pub(crate) mod prose;
pub(crate) mod recorder;
pub mod replay;
pub(crate) mod text;
pub mod track;
