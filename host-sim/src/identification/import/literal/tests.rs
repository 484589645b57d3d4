//! Values as Python works them out, and what is refused.

use super::*;

fn last(text: &str) -> Result<Value, String> {
    assignments(text).pop().unwrap().1
}

#[test]
fn numbers_lists_and_names_are_worked_out_as_python_does() {
    for (text, value) in [
        ("x = 2 * 3 + 4 / 8", 6.5),
        ("x = -2 ** 2", -4.0),
        ("x = 2 ** -1", 0.5),
        ("x = (1 + 2) * 3  # three", 9.0),
        ("x = 1_0.5e-1", 1.05),
        ("\"\"\"x = 1\nx = 2\"\"\"\nimport numpy as np\nd = 3.0\nx = d * np.sqrt(4)", 6.0),
    ] {
        assert_eq!(last(text), Ok(Value::Number(value)), "{text}");
    }
    let list = |numbers: &[f64]| Value::List(numbers.iter().copied().map(Value::Number).collect());
    assert_eq!(last("d = 2\nx = d*np.array([1, -2,\n  3])"), Ok(list(&[2.0, -4.0, 6.0])));
    let read = last("x = {'a': 1, # one\n 'b': (1, 2), \"c\": 'text',}").unwrap();
    assert_eq!(read.get("b"), Some(&list(&[1.0, 2.0])));
    assert_eq!(read.get("c"), Some(&Value::Text("text".to_owned())));
}

#[test]
fn what_would_have_to_be_run_is_refused_by_its_line_and_nothing_overflows() {
    let refused = last("\nx = {\n 'a': open('f')}").unwrap_err();
    assert!(refused.starts_with("line 3: \"open\" cannot be worked out"), "{refused}");
    for text in ["x = {'a' 1}", "x = [1", "x = 'a", "x = {1: 2}", "x = é", "x = [1] + [1, 2]", "x =", "x = 1."] {
        assert_eq!(last(text).is_ok(), text == "x = 1.", "{text}");
    }
    let grown = (0..40).fold("x = [1, 1]\n".to_owned(), |text, _| text + "x = [x, x]\n");
    assert!(last(&grown).unwrap_err().contains("more than 10000 values"));
    for sign in ["(", "[", "-", "{'a':", "2**", "np.array("] {
        assert!(last(&format!("x = {}", sign.repeat(100_000))).unwrap_err().contains("more than 64"), "{sign}");
    }
}
