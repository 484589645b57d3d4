//! Definitions of `proofs/*.v`, evaluated in double precision: what Coq proves something of is what the code computes.
//!
//! It reads the terms that those files use: numbers, `+ - * /`, `sqrt`, `exp`, `Rmax`, `Rmin`, records with their
//! fields, `if R…_dec … then … else …`, and other definitions. Variables of a section are given by the caller.

use std::collections::BTreeMap;
use std::fs;

/// What a term is.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Number(f64),
    Record(BTreeMap<String, Value>),
}

impl Value {
    pub fn number(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Record(_) => panic!("{self:?} is no number"),
        }
    }

    /// The record of these fields.
    pub fn record(fields: &[(&str, f64)]) -> Self {
        Self::Record(fields.iter().map(|(name, x)| ((*name).to_owned(), Self::Number(*x))).collect())
    }
}

/// A file's definitions: each with its arguments and its term.
pub struct Proofs {
    definitions: BTreeMap<String, (Vec<String>, Vec<String>)>,
    variables: BTreeMap<String, Value>,
}

impl Proofs {
    /// Of `proofs/<name>.v`.
    pub fn read(name: &str) -> Self {
        let path = format!("{}/../proofs/{name}.v", env!("CARGO_MANIFEST_DIR"));
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let words = words(&without_comments(&text));
        let mut definitions = BTreeMap::new();
        for sentence in words.split(|word| word == ".") {
            let [keyword, name, rest @ ..] = sentence else { continue };
            if keyword == "Definition" {
                let is = rest.iter().position(|word| word == ":=").expect("a definition has a term");
                let arguments = arguments(&rest[..is]);
                definitions.insert(name.clone(), (arguments, rest[is + 1..].to_vec()));
            }
        }
        Self { definitions, variables: BTreeMap::new() }
    }

    /// With variables of its sections.
    pub fn with(mut self, variables: &[(&str, f64)]) -> Self {
        self.variables.extend(variables.iter().map(|(name, x)| ((*name).to_owned(), Value::Number(*x))));
        self
    }

    /// With a variable that is a record.
    pub fn with_record(mut self, name: &str, value: Value) -> Self {
        self.variables.insert(name.to_owned(), value);
        self
    }

    /// A definition of these arguments.
    pub fn value(&self, name: &str, arguments: &[Value]) -> Value {
        let (names, term) = self.definitions.get(name).unwrap_or_else(|| panic!("no definition {name}"));
        assert_eq!(names.len(), arguments.len(), "{name}");
        let mut known = self.variables.clone();
        known.extend(names.iter().cloned().zip(arguments.iter().cloned()));
        let mut reader = Reader { proofs: self, known: &known, words: term, at: 0 };
        let value = reader.sum();
        assert_eq!(reader.at, term.len(), "{name}: {:?} is not understood", &term[reader.at..]);
        value
    }

    /// The same of numbers.
    pub fn number(&self, name: &str, arguments: &[f64]) -> f64 {
        self.value(name, &arguments.iter().map(|x| Value::Number(*x)).collect::<Vec<_>>()).number()
    }
}

fn without_comments(text: &str) -> String {
    let mut parts = text.split("(*");
    let first = parts.next().unwrap_or_default().to_owned();
    first + &parts.map(|part| part.split_once("*)").expect("comments do not nest").1).collect::<String>()
}

/// Words and signs; a full stop ends a sentence.
fn words(text: &str) -> Vec<String> {
    let spaced = [":=", "{|", "|}"]
        .iter()
        .fold(text.replace(['\n', '\t'], " "), |text, sign| text.replace(sign, &format!(" {sign} ")));
    let mut words: Vec<String> = Vec::new();
    for word in spaced.split_whitespace() {
        if matches!(word, ":=" | "{|" | "|}") {
            words.push(word.to_owned());
            continue;
        }
        let mut name = String::new();
        for sign in word.chars() {
            if sign.is_alphanumeric() || sign == '_' || sign == '\'' {
                name.push(sign);
            } else {
                words.extend((!name.is_empty()).then(|| std::mem::take(&mut name)));
                words.push(sign.to_string());
            }
        }
        words.extend((!name.is_empty()).then_some(name));
    }
    words
}

/// The names in `(a b : R) (c : plane) : R`.
fn arguments(words: &[String]) -> Vec<String> {
    let mut names = Vec::new();
    let (mut inside, mut typed) = (false, false);
    for word in words {
        match word.as_str() {
            "(" => (inside, typed) = (true, false),
            ")" => inside = false,
            ":" if inside => typed = true,
            name if inside && !typed => names.push(name.to_owned()),
            _ => {}
        }
    }
    names
}

struct Reader<'a> {
    proofs: &'a Proofs,
    known: &'a BTreeMap<String, Value>,
    words: &'a [String],
    at: usize,
}

impl Reader<'_> {
    fn peek(&self) -> &str {
        self.words.get(self.at).map_or("", String::as_str)
    }

    fn next(&mut self) -> String {
        self.at += 1;
        self.words[self.at - 1].clone()
    }

    fn expect(&mut self, sign: &str) {
        assert_eq!(self.next(), sign);
    }

    fn sum(&mut self) -> Value {
        let mut value = self.product();
        while matches!(self.peek(), "+" | "-") {
            let sign = self.next();
            let (left, right) = (value.number(), self.product().number());
            value = Value::Number(if sign == "+" { left + right } else { left - right });
        }
        value
    }

    fn product(&mut self) -> Value {
        let mut value = self.signed();
        while matches!(self.peek(), "*" | "/") {
            let sign = self.next();
            let (left, right) = (value.number(), self.signed().number());
            value = Value::Number(if sign == "*" { left * right } else { left / right });
        }
        value
    }

    fn signed(&mut self) -> Value {
        match self.peek() {
            "-" => {
                self.next();
                Value::Number(-self.signed().number())
            }
            "/" => {
                self.next();
                Value::Number(1.0 / self.signed().number())
            }
            "if" => self.choice(),
            _ => self.application(),
        }
    }

    fn choice(&mut self) -> Value {
        self.expect("if");
        let test = self.next();
        let (left, right) = (self.atom().number(), self.atom().number());
        let holds = match test.as_str() {
            "Rle_dec" => left <= right,
            "Rlt_dec" => left < right,
            other => panic!("test {other}"),
        };
        self.expect("then");
        let yes = self.sum();
        self.expect("else");
        let no = self.sum();
        if holds { yes } else { no }
    }

    /// A name with its arguments, or an atom.
    fn application(&mut self) -> Value {
        let name = self.peek().to_owned();
        let count = match name.as_str() {
            "sqrt" | "exp" | "Rabs" => 1,
            "Rmax" | "Rmin" => 2,
            _ if self.known.contains_key(&name) => 0,
            _ => match self.proofs.definitions.get(&name) {
                Some((names, _)) => names.len(),
                None if name.starts_with(|sign: char| sign.is_alphabetic()) => 1,
                None => 0,
            },
        };
        if count == 0 && !self.proofs.definitions.contains_key(&name) {
            return self.atom();
        }
        self.next();
        let arguments: Vec<Value> = (0..count).map(|_| self.atom()).collect();
        let numbers = || arguments.iter().map(Value::number).collect::<Vec<f64>>();
        match (name.as_str(), arguments.first()) {
            ("sqrt", _) => Value::Number(numbers()[0].sqrt()),
            ("exp", _) => Value::Number(numbers()[0].exp()),
            ("Rabs", _) => Value::Number(numbers()[0].abs()),
            ("Rmax", _) => Value::Number(numbers()[0].max(numbers()[1])),
            ("Rmin", _) => Value::Number(numbers()[0].min(numbers()[1])),
            (_, Some(Value::Record(fields))) if !self.proofs.definitions.contains_key(&name) => fields[&name].clone(),
            _ => self.proofs.value(&name, &arguments),
        }
    }

    fn atom(&mut self) -> Value {
        let word = self.next();
        match word.as_str() {
            "(" => {
                let value = self.sum();
                self.expect(")");
                value
            }
            "{|" => {
                let mut fields = BTreeMap::new();
                while self.peek() != "|}" {
                    let name = self.next();
                    self.expect(":=");
                    let value = self.sum();
                    fields.insert(name, value);
                    if self.peek() == ";" {
                        self.next();
                    }
                }
                self.expect("|}");
                Value::Record(fields)
            }
            name => self.known.get(name).cloned().unwrap_or_else(|| match name.parse() {
                Ok(number) => Value::Number(number),
                Err(_) => self.proofs.value(name, &[]),
            }),
        }
    }
}
