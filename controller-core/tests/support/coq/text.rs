//! The text of a file in words.

pub(super) fn without_comments(text: &str) -> String {
    let mut parts = text.split("(*");
    let first = parts.next().unwrap_or_default().to_owned();
    first + &parts.map(|part| part.split_once("*)").expect("comments do not nest").1).collect::<String>()
}

/// The signs of more than one character, longer ones first.
const SIGNS: [&str; 10] = ["<->", ":=", "{|", "|}", "->", "=>", "/\\", "<=", ">=", "<>"];

/// Words and signs; a full stop ends a sentence.
pub fn words(text: &str) -> Vec<String> {
    let part_of_name = |sign: char| sign.is_alphanumeric() || sign == '_' || sign == '\'';
    let (mut words, mut rest) = (Vec::new(), text.trim_start());
    while let Some(first) = rest.chars().next() {
        let name = rest.find(|sign| !part_of_name(sign)).unwrap_or(rest.len());
        let sign = SIGNS.iter().find(|sign| rest.starts_with(**sign)).map_or(first.len_utf8(), |sign| sign.len());
        let (word, after) = rest.split_at(if name > 0 { name } else { sign });
        words.push(word.to_owned());
        rest = after.trim_start();
    }
    words
}
