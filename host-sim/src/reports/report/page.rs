//! A page: a head with its verdict, sections of blocks, the data of all figures, and the program that draws them.

use super::distribution::Distribution;
use super::plot::{Plot, STYLE_SHEET};
use super::prose::{Fact, Table, facts, listing, verdict_words};
use super::replay::Replay;
use super::text::{anchor, escaped, json};
use super::track::Track;
use crate::reports::plots::drawing::Inks;
use crate::reports::plots::{panel, path};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// The program's parts, in the order in which they need each other; together they are one function.
const SCRIPTS: [&str; 8] = [
    include_str!("../../../report/data.js"),
    include_str!("../../../report/legend.js"),
    include_str!("../../../report/chart.js"),
    include_str!("../../../report/plots.js"),
    include_str!("../../../report/space.js"),
    include_str!("../../../report/stage.js"),
    include_str!("../../../report/replay.js"),
    include_str!("../../../report/distributions.js"),
];

/// A part of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// Quantities with their values.
    Facts(Vec<Fact>),
    /// A table.
    Table(Table),
    /// Tables side by side, folded away.
    Folded(String, Vec<Table>),
    /// A text as it stands, folded away.
    Listing(String, String),
    /// Curves over one time axis that all plots of the page share.
    Plots(Vec<Plot>),
    /// Vehicles in motion.
    Replay(Replay),
    /// How quantities are spread.
    Distributions(Vec<Distribution>),
}

/// A part of a page, with a heading.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// The heading.
    pub title: String,
    /// Its blocks.
    pub blocks: Vec<Block>,
}

/// A whole page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Page {
    /// The scenario's name.
    pub title: String,
    /// The kind of page: a flight, a comparison, a campaign.
    pub kind: String,
    /// Whether everything holds, and that in a sentence.
    pub verdict: Option<(bool, String)>,
    /// The first paragraph.
    pub lead: String,
    /// The figures that a reader looks for first.
    pub highlights: Vec<Fact>,
    /// Its columns over time.
    pub tracks: Vec<Track>,
    /// The page itself.
    pub sections: Vec<Section>,
}

/// The page's state that figures need while it is written.
#[derive(Default)]
struct Figures {
    plots: Vec<Value>,
    replays: Vec<Value>,
    distributions: Vec<Value>,
}

impl Page {
    /// The page as one self-contained HTML file.
    #[must_use]
    pub fn html(&self) -> String {
        let mut figures = Figures::default();
        let mut body = String::new();
        for section in &self.sections {
            let (title, place) = (escaped(&section.title), anchor(&section.title));
            let _ = writeln!(body, "<section aria-labelledby=\"{place}\"><h2 id=\"{place}\">{title}</h2>");
            section.blocks.iter().for_each(|block| self.write_block(&mut body, &mut figures, block));
            body += "</section>\n";
        }
        let tracks: Vec<Value> = self.tracks.iter().map(Track::json).collect();
        let data = json(&json!({ "tracks": tracks, "plots": figures.plots, "replays": figures.replays,
            "distributions": figures.distributions }));
        let (title, kind) = (escaped(&self.title), escaped(&self.kind));
        let program = format!("\"use strict\";\n(() => {{\n{}}})();\n", SCRIPTS.concat());
        let policy = format!(
            "default-src 'none'; script-src '{}'; style-src '{}'; base-uri 'none'; form-action 'none'",
            digest(&program),
            digest(STYLE_SHEET)
        );
        let version = env!("CARGO_PKG_VERSION");
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n\
             <title>{title}: {kind}</title>\n<style>{STYLE_SHEET}</style>\n</head>\n<body>\n\
             <a class=\"skip\" href=\"#content\">Skip to the content</a>\n{}{}<main id=\"content\">\n{body}</main>\n\
             <footer>Written by host-sim {version}. This file needs no network and asks for none.</footer>\n\
             <noscript><p class=\"lead\">Without JavaScript plots and paths are still pictures, and distributions are tables.</p></noscript>\n\
             <div id=\"live\" class=\"unseen\" role=\"status\" aria-live=\"polite\"></div>\n\
             <script type=\"application/json\" id=\"data\">{data}</script>\n<script>{program}</script>\n</body>\n</html>\n",
            self.head(&title, &kind),
            self.contents(),
        )
    }

    fn head(&self, title: &str, kind: &str) -> String {
        let verdict = self.verdict.as_ref().map_or(String::new(), |(holds, sentence)| {
            format!("<p class=\"verdict {}\">{}</p>\n", verdict_words(Some(*holds)).0, escaped(sentence))
        });
        let highlights = if self.highlights.is_empty() { String::new() } else { facts(&self.highlights) };
        format!(
            "<header>\n<p class=\"kind\">{kind}</p>\n<h1>{title}</h1>\n{verdict}<p class=\"lead\">{}</p>\n{highlights}</header>\n",
            escaped(&self.lead)
        )
    }

    fn contents(&self) -> String {
        let links = self.sections.iter().fold(String::new(), |links, section| {
            links + &format!("<li><a href=\"#{}\">{}</a></li>", anchor(&section.title), escaped(&section.title))
        });
        format!("<nav aria-label=\"Contents\"><ul>{links}</ul></nav>\n")
    }

    fn write_block(&self, html: &mut String, figures: &mut Figures, block: &Block) {
        match block {
            Block::Text(text) => *html += &format!("<p>{}</p>\n", escaped(text)),
            Block::Facts(list) => *html += &facts(list),
            Block::Table(table) => *html += &table.html(),
            Block::Folded(name, tables) => {
                let tables: String = tables.iter().map(Table::html).collect();
                *html += &format!(
                    "<details><summary>{}</summary><div class=\"tables\">{tables}</div></details>\n",
                    escaped(name)
                );
            }
            Block::Listing(name, text) => *html += &listing(name, text),
            Block::Plots(plots) => {
                *html += "<div class=\"plots\">\n";
                for plot in plots {
                    let still = panel::picture(plot, &self.tracks);
                    *html += &figure("plot", figures.plots.len(), &plot.title, &still, &plot.table(&self.tracks));
                    figures.plots.push(plot.json());
                }
                *html += "</div>\n";
            }
            Block::Replay(replay) => {
                let track = replay.bodies.first().and_then(|body| self.tracks.get(body.track));
                let still =
                    track.map_or_else(String::new, |track| path::picture(track).svg(Inks::Page, "The path in space"));
                *html += &format!(
                    "<div class=\"replay\" data-replay=\"{}\"><noscript>{still}</noscript></div>\n",
                    figures.replays.len()
                );
                figures.replays.push(replay.json());
            }
            Block::Distributions(distributions) => {
                *html += "<div class=\"plots\">\n";
                for spread in distributions {
                    let place = figures.distributions.len();
                    *html += &figure("distribution", place, &spread.title, "", &spread.table());
                    figures.distributions.push(spread.json());
                }
                *html += "</div>\n";
            }
        }
    }
}

/// A place for a drawing, with its heading, what is `still` there without the program, and its figures as a table.
fn figure(kind: &str, place: usize, title: &str, still: &str, table: &Table) -> String {
    let still = if still.is_empty() { String::new() } else { format!("<noscript>{still}</noscript>") };
    format!(
        "<figure data-{kind}=\"{place}\"><h3>{}</h3><div class=\"drawing\">{still}</div>\
         <details><summary>In figures<span class=\"unseen\">: {}</span></summary>{}</details></figure>\n",
        escaped(title),
        escaped(title),
        table.html()
    )
}

/// How a policy names a text that may be used.
fn digest(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
mod tests;
