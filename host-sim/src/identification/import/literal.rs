//! Python of parameter files: assignments of numbers, texts, lists and dictionaries, with the four operations, powers,
//! `np.array(…)`, `np.sqrt(…)` and names that were assigned before. Nothing is run; every other statement is passed
//! over. A crate that reads all of Python would be larger than this program's own readers together, and would still
//! leave these values to be worked out.

use super::value::Value;
use std::collections::HashMap;
use std::f64::consts::PI;

const BRACKET_DEPTH_MAX: usize = 64;
/// How many values names may stand for, all together: lists of lists by name would grow without end.
const REPEATED_VALUES_MAX: usize = 10_000;

/// What a file assigns at its outermost level, in its order: each name with its value, or with what of it cannot be
/// worked out.
pub fn assignments(text: &str) -> Vec<(String, Result<Value, String>)> {
    let mut found = Vec::new();
    let mut reader = Reader { text, at: 0, line: 1, depth: 0, names: HashMap::new(), repeated: 0 };
    while reader.at < text.len() {
        let start = (reader.at, reader.line);
        let name = reader.name().to_owned();
        reader.spaces();
        if !name.is_empty() && reader.rest().starts_with('=') && !reader.rest().starts_with("==") {
            reader.at += 1;
            let value = reader.expression();
            if let Ok(value) = &value {
                reader.names.insert(name.clone(), value.clone());
            }
            found.push((name, value));
        } else {
            (reader.at, reader.line) = start;
        }
        reader.pass_line();
    }
    found
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    line: usize,
    depth: usize,
    names: HashMap<String, Value>,
    /// How many values stand in it by names.
    repeated: usize,
}

impl<'a> Reader<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn refused<T>(&self, problem: &str) -> Result<T, String> {
        Err(format!("line {}: {problem}", self.line))
    }

    /// Goes on to the line after this one; a text of several lines is one.
    fn pass_line(&mut self) {
        while let Some(c) = self.rest().chars().next() {
            match c {
                '\n' => {
                    (self.at, self.line) = (self.at + 1, self.line + 1);
                    return;
                }
                '#' => self.at += self.rest().find('\n').unwrap_or(self.rest().len()),
                '"' | '\'' if self.quoted().is_some() => {}
                _ => self.at += c.len_utf8(),
            }
        }
    }

    /// Passes spaces, and inside brackets line ends and comments.
    fn spaces(&mut self) {
        while let Some(c) = self.rest().chars().next() {
            match c {
                '\n' if self.depth > 0 => (self.at, self.line) = (self.at + 1, self.line + 1),
                '#' if self.depth > 0 => self.at += self.rest().find('\n').unwrap_or(self.rest().len()),
                '\\' if self.rest().starts_with("\\\n") => (self.at, self.line) = (self.at + 2, self.line + 1),
                ' ' | '\t' | '\r' => self.at += 1,
                _ => return,
            }
        }
    }

    fn takes(&mut self, sign: &str) -> bool {
        self.spaces();
        let is_there = self.rest().starts_with(sign);
        self.at += if is_there { sign.len() } else { 0 };
        is_there
    }

    /// A name, with its points; empty if there is none.
    fn name(&mut self) -> &'a str {
        let rest = self.rest();
        let inside =
            |(index, c): (usize, char)| c == '_' || c.is_alphabetic() || index > 0 && (c == '.' || c.is_numeric());
        let end = rest.char_indices().find(|&each| !inside(each)).map_or(rest.len(), |(index, _)| index);
        self.at += end;
        &rest[..end]
    }

    /// A quoted text, if one begins and ends.
    fn quoted(&mut self) -> Option<String> {
        let rest = self.rest();
        let quote = ["\"\"\"", "'''", "\"", "'"].into_iter().find(|quote| rest.starts_with(quote))?;
        let inside = &rest[quote.len()..];
        let mut end = 0;
        while !inside[end..].starts_with(quote) {
            let c = inside[end..].chars().next().filter(|&c| c != '\n' || quote.len() == 3)?;
            end += c.len_utf8();
            if c == '\\' {
                end += inside[end..].chars().next()?.len_utf8();
            }
        }
        let inside = &inside[..end];
        self.at += 2 * quote.len() + end;
        self.line += inside.matches('\n').count();
        Some(inside.to_owned())
    }

    fn expression(&mut self) -> Result<Value, String> {
        let mut value = self.product()?;
        loop {
            value = if self.takes("+") {
                let other = self.product()?;
                self.each(&value, &other, |a, b| a + b)?
            } else if self.takes("-") {
                let other = self.product()?;
                self.each(&value, &other, |a, b| a - b)?
            } else {
                return Ok(value);
            };
        }
    }

    fn product(&mut self) -> Result<Value, String> {
        let mut value = self.signed()?;
        loop {
            self.spaces();
            value = if !self.rest().starts_with("**") && self.takes("*") {
                let other = self.signed()?;
                self.each(&value, &other, |a, b| a * b)?
            } else if !self.rest().starts_with("//") && self.takes("/") {
                let other = self.signed()?;
                self.each(&value, &other, |a, b| a / b)?
            } else {
                return Ok(value);
            };
        }
    }

    fn signed(&mut self) -> Result<Value, String> {
        if self.takes("-") {
            let value = self.deeper(Self::signed)?;
            return self.each(&Value::Number(-1.0), &value, |a, b| a * b);
        }
        if self.takes("+") {
            return self.deeper(Self::signed);
        }
        let value = self.operand()?;
        if self.takes("**") {
            let power = self.deeper(Self::signed)?;
            return self.each(&value, &power, f64::powf);
        }
        Ok(value)
    }

    /// What `read` reads, unless it lies too deep.
    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T, String>) -> Result<T, String> {
        if self.depth >= BRACKET_DEPTH_MAX {
            return self.refused(&format!("lies in more than {BRACKET_DEPTH_MAX} brackets"));
        }
        self.depth += 1;
        let read = read(self);
        self.depth -= 1;
        read
    }

    fn operand(&mut self) -> Result<Value, String> {
        self.spaces();
        let Some(c) = self.rest().chars().next() else { return self.refused("the file ends inside an expression") };
        match c {
            '(' | '[' => self.deeper(Self::list),
            '{' => self.deeper(Self::dictionary),
            '"' | '\'' => match self.quoted() {
                Some(text) => Ok(Value::Text(text)),
                None => self.refused("a text that does not end"),
            },
            '0'..='9' | '.' => self.number(),
            _ => self.named(),
        }
    }

    fn number(&mut self) -> Result<Value, String> {
        let rest = self.rest();
        let mut before = ' ';
        let is_inside = |&(_, c): &(usize, char)| {
            let is_sign = matches!(c, '+' | '-') && matches!(before, 'e' | 'E');
            before = c;
            is_sign || c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E' | '_')
        };
        let length = rest.char_indices().take_while(is_inside).count();
        let written = &rest[..length];
        match written.replace('_', "").parse() {
            Ok(number) => {
                self.at += length;
                Ok(Value::Number(number))
            }
            Err(_) => self.refused(&format!("{:?} is not a number", &written[..length.min(40)])),
        }
    }

    /// A name that was assigned, a constant, or a function of a value.
    fn named(&mut self) -> Result<Value, String> {
        let name = self.name();
        match name {
            "True" => return Ok(Value::Number(1.0)),
            "False" => return Ok(Value::Number(0.0)),
            "None" => return Ok(Value::Other),
            "np.pi" | "numpy.pi" | "math.pi" => return Ok(Value::Number(PI)),
            _ => {}
        }
        if let Some(value) = self.names.get(name) {
            self.repeated += value.size();
            return match self.repeated <= REPEATED_VALUES_MAX {
                true => Ok(value.clone()),
                false => self.refused(&format!("names stand for more than {REPEATED_VALUES_MAX} values")),
            };
        }
        let function = name.rsplit('.').next().unwrap_or_default();
        let known = matches!(function, "array" | "asarray" | "sqrt" | "float" | "int");
        if !known || !self.takes("(") {
            let shown: String = if name.is_empty() { self.rest().chars().take(1).collect() } else { name.to_owned() };
            let remedy = "put its value there as a number, a list or a dictionary";
            return self.refused(&format!("{shown:?} cannot be worked out without running the file: {remedy}"));
        }
        let value = self.deeper(|reader| {
            let value = reader.expression()?;
            reader.takes(",");
            if reader.takes(")") { Ok(value) } else { reader.refused("must have one argument in brackets") }
        })?;
        match function {
            "sqrt" => self.each(&value, &Value::Number(0.5), f64::powf),
            _ => Ok(value),
        }
    }

    /// A list, or what stands in brackets.
    fn list(&mut self) -> Result<Value, String> {
        let is_list = self.takes("[");
        let end = if is_list { "]" } else { ")" };
        if !is_list {
            self.takes("(");
        }
        let mut elements = Vec::new();
        let mut has_comma = false;
        while !self.takes(end) {
            elements.push(self.expression()?);
            if self.takes(",") {
                has_comma = true;
            } else if !self.takes(end) {
                return self.refused(&format!("',' or '{end}' is missing"));
            } else {
                break;
            }
        }
        match elements.pop() {
            Some(single) if !is_list && !has_comma => Ok(single),
            last => {
                elements.extend(last);
                Ok(Value::List(elements))
            }
        }
    }

    fn dictionary(&mut self) -> Result<Value, String> {
        self.takes("{");
        let mut entries = Vec::new();
        while !self.takes("}") {
            let Value::Text(key) = self.expression()? else { return self.refused("a key must be a text") };
            if !self.takes(":") {
                return self.refused(&format!("':' is missing after {key:?}"));
            }
            entries.push((key, self.expression()?));
            if !self.takes(",") {
                if self.takes("}") {
                    break;
                }
                return self.refused("',' or '}' is missing");
            }
        }
        Ok(Value::Dictionary(entries))
    }

    /// An operation on two numbers, or on each element of lists.
    fn each(&self, one: &Value, other: &Value, of: fn(f64, f64) -> f64) -> Result<Value, String> {
        let all = |pairs: Vec<(&Value, &Value)>| {
            let all: Result<Vec<Value>, String> = pairs.into_iter().map(|(a, b)| self.each(a, b, of)).collect();
            all.map(Value::List)
        };
        match (one, other) {
            (Value::Number(a), Value::Number(b)) => Ok(Value::Number(of(*a, *b))),
            (Value::List(list), Value::Number(_)) => all(list.iter().map(|element| (element, other)).collect()),
            (Value::Number(_), Value::List(list)) => all(list.iter().map(|element| (one, element)).collect()),
            (Value::List(a), Value::List(b)) if a.len() == b.len() => all(a.iter().zip(b).collect()),
            _ => self.refused("only numbers, and arrays of one length, can be added or multiplied"),
        }
    }
}

#[cfg(test)]
mod tests;
