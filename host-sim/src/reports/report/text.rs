//! Text from elsewhere, made harmless: names and comments come from untrusted files.

use serde_json::Value;

/// `text` as HTML, for elements and for quoted attributes.
pub fn escaped(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut safe, character| {
        match character {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            other => safe.push(other),
        }
        safe
    })
}

/// `value` as JSON that may stand inside a `<script>` element: it cannot end that element or open a comment.
pub fn json(value: &Value) -> String {
    // These characters stand in strings only.
    value.to_string().replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

/// `text` as the name of a place in the page: letters, digits and hyphens.
pub fn anchor(text: &str) -> String {
    let kept = text.to_lowercase();
    kept.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty()).collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn nothing_in_a_text_opens_or_closes_an_element_or_an_attribute() {
        let safe = escaped("</script><b title=\"x\" id='y'>&amp;");
        assert_eq!(safe, "&lt;/script&gt;&lt;b title=&quot;x&quot; id=&#39;y&#39;&gt;&amp;amp;");
    }

    #[test]
    fn json_reads_back_and_holds_no_angle_bracket() {
        let value = json!({ "</script>": "<!-- & \"quoted\" \\ -->" });
        let text = super::json(&value);
        assert!(!text.contains(['<', '>', '&']), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }

    #[test]
    fn a_place_is_named_by_letters_digits_and_hyphens() {
        assert_eq!(anchor("Thrust & torques: 2.0"), "thrust-torques-2-0");
    }
}
