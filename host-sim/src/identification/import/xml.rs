//! What the three XML formats have in common: a document, and numbers in its elements, with errors that name the line
//! and the element. Documents with a DTD are refused, and with it entities of a file's own.

use roxmltree::{Document, Node};

/// No vehicle nests deeper, and readers recurse.
const ELEMENT_DEPTH_MAX: usize = 64;

/// Reads a document.
///
/// # Errors
/// With the place where it is no XML.
pub fn document(text: &str) -> Result<Document<'_>, String> {
    let document = Document::parse(text).map_err(|error| match error {
        roxmltree::Error::DtdDetected => {
            "has a document type (<!DOCTYPE …>), which is refused: remove it, and expand entities of its own".to_owned()
        }
        roxmltree::Error::UnknownNamespace(prefix, place) => format!(
            "line {}: the prefix {prefix} is not declared: write <sdf xmlns:{prefix}=\"{prefix}\"> in place of <sdf>, or \
             likewise in the outermost element",
            place.row
        ),
        error => format!("not XML: {error}"),
    })?;
    let too_deep = document.descendants().find(|node| node.ancestors().nth(ELEMENT_DEPTH_MAX).is_some());
    match too_deep.map(|node| place(&node)) {
        Some(place) => Err(format!("{place}: lies in more than {ELEMENT_DEPTH_MAX} elements")),
        None => Ok(document),
    }
}

/// Where an element stands, as errors call it.
pub fn place(node: &Node) -> String {
    let line = node.document().text_pos_at(node.range().start).row;
    let name = node.attribute("name").map_or(String::new(), |name| format!(" name={name:?}"));
    format!("line {line}: <{}{name}>", node.tag_name().name())
}

/// The first child element called `name`.
pub fn child<'a, 'input>(node: &Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    children(node, name).next()
}

/// All child elements called `name`.
pub fn children<'a, 'input, 'n>(
    node: &Node<'a, 'input>,
    name: &'n str,
) -> impl Iterator<Item = Node<'a, 'input>> + use<'a, 'input, 'n> {
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// An attribute that must be there.
///
/// # Errors
/// If it is not.
pub fn attribute<'a>(node: &Node<'a, '_>, name: &str) -> Result<&'a str, String> {
    node.attribute(name).ok_or_else(|| format!("{}: attribute {name} is missing", place(node)))
}

/// The text of an element.
pub fn text<'a>(node: &Node<'a, '_>) -> &'a str {
    node.text().unwrap_or("").trim()
}

/// Numbers that `text` at `node` must consist of; `what` names the attribute, or is empty for the element's text.
///
/// # Errors
/// If there are not so many, or one is not finite.
pub fn numbers<const N: usize>(node: &Node, what: &str, text: &str) -> Result<[f64; N], String> {
    let place = || if what.is_empty() { place(node) } else { format!("{}: {what}", place(node)) };
    let list = list(text).map_err(|word| format!("{}: must be finite numbers, found {word:?}", place()))?;
    let found = list.len();
    <[f64; N]>::try_from(list).map_err(|_| {
        let wanted = if N == 1 { "one number".to_owned() } else { format!("{N} numbers") };
        format!("{}: must be {wanted}, found {found}", place())
    })
}

/// One number, likewise.
pub fn number(node: &Node, what: &str, text: &str) -> Result<f64, String> {
    numbers(node, what, text).map(|[number]| number)
}

/// The number in the child element `name`; none without the element.
pub fn child_number(node: &Node, name: &str) -> Result<Option<f64>, String> {
    child(node, name).map(|child| number(&child, "", text(&child))).transpose()
}

/// The numbers of the attribute `name`; `otherwise` without it.
pub fn attribute_numbers<const N: usize>(node: &Node, name: &str, otherwise: [f64; N]) -> Result<[f64; N], String> {
    node.attribute(name).map_or(Ok(otherwise), |text| numbers(node, name, text))
}

/// Refuses a mass that no body has.
///
/// # Errors
/// If it is negative.
pub fn mass(node: &Node, mass: f64) -> Result<f64, String> {
    if mass < 0.0 {
        return Err(format!("{}: the mass must not be negative, found {mass}", place(node)));
    }
    Ok(mass)
}

/// Finite numbers between spaces, or the word that is not a number; a word as short as an error has room for.
fn list(text: &str) -> Result<Vec<f64>, String> {
    let finite = |word: &str| word.parse().ok().filter(|number: &f64| number.is_finite());
    let refused = |word: &str| word.chars().take(40).collect::<String>();
    text.split_whitespace().map(|word| finite(word).ok_or_else(|| refused(word))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entities_of_a_files_own_and_endless_nesting_are_refused() {
        let bomb = "<!DOCTYPE a [<!ENTITY b \"bb\"><!ENTITY c \"&b;&b;\">]><a>&c;</a>";
        assert!(document(bomb).unwrap_err().contains("document type"));
        let deep = "<a>".repeat(100_000) + &"</a>".repeat(100_000);
        assert!(document(&deep).is_err());
        assert!(document(&("<a>".repeat(65) + &"</a>".repeat(65))).unwrap_err().contains("more than 64"));
        assert!(document("<a><b></a>").unwrap_err().starts_with("not XML"));
    }

    #[test]
    fn what_is_no_number_is_refused_by_line_and_element() {
        let document = document("<a>\n<b name=\"c\" d=\"1 two\">1 2</b></a>").unwrap();
        let b = child(&document.root_element(), "b").unwrap();
        let refused = attribute_numbers(&b, "d", [0.0; 2]).unwrap_err();
        assert_eq!(refused, "line 2: <b name=\"c\">: d: must be finite numbers, found \"two\"");
        assert_eq!(number(&b, "", text(&b)).unwrap_err(), "line 2: <b name=\"c\">: must be one number, found 2");
        assert_eq!(numbers(&b, "", text(&b)), Ok([1.0, 2.0]));
    }
}
