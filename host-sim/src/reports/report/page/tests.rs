use super::*;
use crate::reports::report::plot::{Bound, Color, Curve};
use crate::reports::report::prose::Cell;
use crate::reports::report::replay::Body;

/// Text of a file that tries to break out of a page.
const HOSTILE_TEXT: &str = "</script><script>alert(1)</script><img src=x onerror=\"alert('2')\"> & <!-- é";

fn page(text: &str) -> Page {
    let mut table = Table::new(text, &[text, "verdict"]);
    table.rows = [Some(true), Some(false), None].map(|holds| vec![Cell::text(text), Cell::Verdict(holds)]).into();
    let bound = Bound { value: 1.5, label: text.into(), color: Color::Ink, always: true };
    let plot = Plot::new(text, text, vec![Curve::new("px", text, Color::Blue)]).within(vec![bound]);
    let body = Body { track: 0, label: text.into(), color: Color::Green };
    let groups = vec![(text.to_owned(), vec![1.0, 2.0])];
    let spread = Distribution {
        title: text.into(),
        unit: text.into(),
        logarithmic: false,
        bound: None,
        groups,
        looks: Vec::new(),
    };
    let blocks = vec![
        Block::Text(text.into()),
        Block::Facts(vec![Fact::new(text, text)]),
        Block::Table(table.clone()),
        Block::Folded(text.into(), vec![table]),
        Block::Listing(text.into(), text.into()),
        Block::Plots(vec![plot]),
        Block::Replay(Replay { bodies: vec![body], rotors: vec![[1.0, 2.0, 3.0]], hover_thrust: 4.5 }),
        Block::Distributions(vec![spread]),
    ];
    Page {
        title: text.into(),
        kind: text.into(),
        verdict: Some((false, text.into())),
        lead: text.into(),
        highlights: vec![Fact::new(text, text)],
        tracks: vec![Track { name: text.into(), start: 0.0, step: 0.1, columns: vec![("px".into(), vec![1.0, -2.5])] }],
        sections: vec![Section { title: text.into(), blocks }],
    }
}

/// The elements of a page in order, end tags too, with what stands in them taken as it is.
fn elements(html: &str) -> Vec<String> {
    html.split('<').skip(1).map(|rest| rest.split(['>', ' ']).next().unwrap_or_default().to_owned()).collect()
}

/// The text between the first `from` and the next `to`.
fn within<'a>(html: &'a str, from: &str, to: &str) -> &'a str {
    let (_, rest) = html.split_once(from).unwrap_or_else(|| panic!("no {from}"));
    rest.split_once(to).unwrap_or_else(|| panic!("no {to}")).0
}

fn data(html: &str) -> Value {
    serde_json::from_str(within(html, "id=\"data\">", "</script>")).unwrap()
}

#[test]
fn text_from_files_adds_no_element_and_is_read_back_as_it_was() {
    let (attacked, harmless) = (page(HOSTILE_TEXT).html(), page(&"h".repeat(HOSTILE_TEXT.chars().count())).html());
    assert_eq!(elements(&attacked), elements(&harmless));
    assert!(!attacked.contains("onerror=\"") && !attacked.contains("<img"), "{attacked}");
    let data = data(&attacked);
    for place in [
        "/plots/0/title",
        "/plots/0/bounds/0/label",
        "/plots/0/curves/0/label",
        "/tracks/0/name",
        "/replays/0/bodies/0/label",
        "/distributions/0/groups/0/label",
    ] {
        assert_eq!(data.pointer(place).and_then(Value::as_str), Some(HOSTILE_TEXT), "{place}");
    }
}

#[test]
fn the_policy_allows_this_style_and_this_program_and_nothing_else() {
    let html = page("policy").html();
    let policy = within(&html, "Content-Security-Policy\" content=\"", "\"");
    let program = html.rsplit_once("<script>").unwrap().1.split_once("</script>").unwrap().0;
    let style = within(&html, "<style>", "</style>");
    let expected = format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; base-uri 'none'; form-action 'none'",
        digest(program),
        digest(style)
    );
    assert_eq!(policy, expected);
    // SHA-256 of nothing, as anybody's tool prints it in base64.
    assert_eq!(digest(""), "sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=");
    // It stands before whatever it is to govern, and nothing needs a style or a handler of its own.
    assert!(html.find("Content-Security-Policy") < html.find("<style>"));
    assert!(!html.contains(" style=") && !html.contains(" onclick="));
}

#[test]
fn there_is_no_address_of_anything_outside_the_page() {
    let html = page("addresses").html();
    for address in
        ["://", "src=", "url(", "@import", "fetch(", "XMLHttpRequest", "import(", "WebSocket", "<link", "<iframe"]
    {
        assert!(!html.contains(address), "{address}");
    }
    assert!(html.matches("href=\"").count() == html.matches("href=\"#").count());
}

#[test]
fn headings_labels_and_tables_say_what_the_figures_show() {
    let html = page("structure").html();
    for (element, count) in
        [("<h1", 1), ("<h2", 1), ("<main", 1), ("<nav", 1), ("<caption", 4), ("lang=\"en\"", 1), ("aria-live", 1)]
    {
        assert_eq!(html.matches(element).count(), count, "{element}");
    }
    // Every figure has a heading and its numbers as a table.
    for figure in html.split("<figure").skip(1) {
        let figure = figure.split_once("</figure>").unwrap().0;
        assert!(figure.contains("<h3>") && figure.contains("<table>") && figure.contains("<summary>"), "{figure}");
    }
    for (verdict, count) in
        [("verdict holds\">holds", 2), ("verdict fails\">FAILS", 2), ("verdict reported\">reported", 2)]
    {
        assert_eq!(html.matches(verdict).count(), count, "{verdict}");
    }
    let plot = within(&html, "data-plot=\"0\"", "</figure>");
    for words in ["-2.5\u{a0}structure", "1\u{a0}structure", "1.5\u{a0}structure"] {
        assert!(plot.contains(words), "{words}: {plot}");
    }
}

#[test]
fn without_the_program_every_plot_and_the_path_are_pictures_in_the_pages_colours() {
    let html = page("still").html();
    assert_eq!(html.matches("<noscript><svg ").count(), 2);
    let plot = within(within(&html, "data-plot=\"0\"", "</figure>"), "<noscript>", "</noscript>");
    for part in ["aria-label=\"still\"", "var(--blue)", "fill=\"var(--card)\"", ">still: 1.5 still</text>"] {
        assert!(plot.contains(part), "{part}: {plot}");
    }
    assert!(!plot.contains('#'), "a colour that is the same in the dark: {plot}");
}

#[test]
fn colours_of_curves_stand_out_from_the_ground_they_are_drawn_on() {
    // WCAG's contrast of 3 to 1 for what is not text; orange is for the reference's broad line, which its key names.
    let light = within(STYLE_SHEET, ":root {", "}");
    let dark = within(STYLE_SHEET, ":root:not([data-print]) {", "}");
    for (name, scheme) in [("light", light), ("dark", dark)] {
        let luminance = |color: &str| {
            let hex = within(scheme, &format!("--{color}: #"), ";");
            let channel = |at: usize| f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0;
            let linear = |c: f64| if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
            0.2126 * linear(channel(0)) + 0.7152 * linear(channel(2)) + 0.0722 * linear(channel(4))
        };
        let contrast = |one: &str, other: &str| {
            let (a, b) = (luminance(one), luminance(other));
            (a.max(b) + 0.05) / (a.min(b) + 0.05)
        };
        for (color, least) in [
            ("blue", 3.0),
            ("vermilion", 3.0),
            ("green", 3.0),
            ("purple", 3.0),
            ("sky", 3.0),
            ("grey", 3.0),
            ("orange", 2.0),
            ("ink", 7.0),
            ("muted", 4.5),
            ("accent", 4.5),
        ] {
            assert!(contrast(color, "card") >= least, "{name}: {color}: {}", contrast(color, "card"));
        }
        for (text, ground) in [("good", "good-ground"), ("bad", "bad-ground")] {
            assert!(contrast(text, ground) >= 4.5, "{name}: {text}: {}", contrast(text, ground));
        }
    }
}
