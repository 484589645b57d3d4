//! Terms, read and evaluated.

use super::statement::Let;
use super::{Proofs, Value};
use std::collections::BTreeMap;

/// What ends the arguments of a function.
const KEYWORDS: [&str; 5] = ["then", "else", "in", "if", "let"];

fn begins_an_atom(word: &str) -> bool {
    matches!(word, "(" | "{|") || word.starts_with(char::is_alphanumeric) && !KEYWORDS.contains(&word)
}

pub(super) struct Reader<'a> {
    pub proofs: &'a Proofs,
    /// Arguments, and what a section's variables are here; what is not among them is the caller's.
    pub known: &'a BTreeMap<String, Value>,
    pub lets: &'a BTreeMap<String, Let>,
    pub words: &'a [String],
    pub at: usize,
    pub rounded: bool,
}

impl<'a> Reader<'a> {
    /// The term from its first word to its last.
    pub fn whole(mut self) -> Value {
        let value = self.sum();
        assert_eq!(self.at, self.words.len(), "{:?} is not understood", &self.words[self.at..]);
        value
    }

    /// What is in the parentheses that open before this word.
    pub fn parenthesis(mut self, place: usize) -> Value {
        self.at = place;
        let words = &self.words[place..self.closing()];
        Reader { words, at: 0, ..self }.whole()
    }

    fn peek(&self) -> &'a str {
        self.words.get(self.at).map_or("", String::as_str)
    }

    fn next(&mut self) -> &'a str {
        self.at += 1;
        &self.words[self.at - 1]
    }

    fn expect(&mut self, sign: &str) {
        assert_eq!(self.next(), sign);
    }

    /// One step's result. Of numbers in single precision, what double precision makes rounds to what single would.
    fn step(&self, result: f64) -> Value {
        Value::Number(if self.rounded { f64::from(result as f32) } else { result })
    }

    fn sum(&mut self) -> Value {
        let mut value = self.product();
        while matches!(self.peek(), "+" | "-") {
            let sign = self.next();
            let (left, right) = (value.number(), self.product().number());
            value = self.step(if sign == "+" { left + right } else { left - right });
        }
        value
    }

    fn product(&mut self) -> Value {
        let mut value = self.signed();
        while matches!(self.peek(), "*" | "/") {
            let sign = self.next();
            let (left, right) = (value.number(), self.signed().number());
            value = self.step(if sign == "*" { left * right } else { left / right });
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
            "let" => self.binding(),
            "fold_right" => self.fold(),
            _ => self.application(),
        }
    }

    fn choice(&mut self) -> Value {
        self.expect("if");
        let test = self.next();
        let (left, right) = (self.atom().number(), self.atom().number());
        let holds = match test {
            "Rle_dec" => left <= right,
            "Rlt_dec" => left < right,
            "Req_EM_T" => left == right,
            other => panic!("test {other}"),
        };
        self.expect("then");
        let yes = self.sum();
        self.expect("else");
        let no = self.sum();
        if holds { yes } else { no }
    }

    /// `let name := term in …`, up to where the parentheses around it close.
    fn binding(&mut self) -> Value {
        self.expect("let");
        let name = self.next();
        self.expect(":=");
        let value = self.sum();
        self.expect("in");
        let mut known = self.known.clone();
        known.insert(name.to_owned(), value);
        let end = self.closing();
        let body = &self.words[self.at..end];
        self.at = end;
        Reader { known: &known, words: body, at: 0, ..*self }.whole()
    }

    /// Where the parentheses that it is in close.
    fn closing(&self) -> usize {
        let mut depth = 0;
        let closes = |word: &String| {
            depth += i32::from(word == "(") - i32::from(word == ")");
            depth < 0
        };
        self.words[self.at..].iter().position(closes).map_or(self.words.len(), |place| self.at + place)
    }

    /// `fold_right (fun element rest => …) start list`.
    fn fold(&mut self) -> Value {
        self.expect("fold_right");
        self.expect("(");
        self.expect("fun");
        let [element, rest] = [self.next(), self.next()];
        self.expect("=>");
        let end = self.closing();
        let body = &self.words[self.at..end];
        self.at = end + 1;
        let (start, Value::List(list)) = (self.atom(), self.atom()) else { panic!("a list is folded") };
        list.into_iter().rev().fold(start, |folded, value| {
            let mut known = self.known.clone();
            known.extend([(element.to_owned(), value), (rest.to_owned(), folded)]);
            Reader { known: &known, words: body, at: 0, ..*self }.whole()
        })
    }

    /// A function with its arguments, which are all the atoms that follow, or an atom.
    fn application(&mut self) -> Value {
        let head = self.at;
        if !self.peek().starts_with(char::is_alphabetic) || !self.words.get(head + 1).is_some_and(|w| begins_an_atom(w))
        {
            return self.atom();
        }
        self.at += 1;
        let mut arguments = Vec::new();
        while begins_an_atom(self.peek()) {
            arguments.push(self.atom());
        }
        let name = self.words[head].as_str();
        if let Some(value) = self.builtin(name, &arguments) {
            return value;
        }
        match (self.variable(name), self.lets.get(name), arguments.as_slice()) {
            (Some(Value::Moving(now)), _, [_]) => Value::clone(now),
            (Some(value), ..) => panic!("{name} is no function, but {value:?}"),
            (_, Some(bound), _) => self.bound(bound, arguments),
            (.., [Value::Record(fields)]) if !self.proofs.defines(name) => fields[name].clone(),
            _ => self.proofs.applied(name, &arguments, self.known),
        }
    }

    /// A function that Coq's library defines.
    fn builtin(&self, name: &str, arguments: &[Value]) -> Option<Value> {
        let of_one: Option<fn(f64) -> f64> = match name {
            "sqrt" => Some(f64::sqrt),
            "exp" => Some(f64::exp),
            "ln" => Some(f64::ln),
            "cos" => Some(f64::cos),
            "sin" => Some(f64::sin),
            "tan" => Some(f64::tan),
            "acos" => Some(f64::acos),
            "asin" => Some(f64::asin),
            "Rabs" => Some(f64::abs),
            // A section's variable: rounding to single precision.
            "rnd" => Some(|x| f64::from(x as f32)),
            // Natural numbers: the next one, and the same as a real number.
            "S" => Some(|n| n + 1.0),
            "INR" => Some(|n| n),
            _ => None,
        };
        let of_two: Option<fn(f64, f64) -> f64> = match name {
            "Rmax" => Some(f64::max),
            "Rmin" => Some(f64::min),
            "Rpower" => Some(f64::powf),
            _ => None,
        };
        match (of_one, of_two, arguments) {
            (Some(function), _, [x]) => Some(self.step(function(x.number()))),
            (_, Some(function), [x, y]) => Some(self.step(function(x.number(), y.number()))),
            _ => None,
        }
    }

    /// What a `let` binds, of these arguments.
    pub fn bound(&self, bound: &Let, arguments: Vec<Value>) -> Value {
        assert_eq!(bound.arguments.len(), arguments.len(), "{bound:?}");
        let mut known = self.known.clone();
        known.extend(bound.arguments.iter().cloned().zip(arguments));
        Reader { known: &known, words: &bound.term, at: 0, ..*self }.whole()
    }

    fn variable(&self, name: &str) -> Option<&Value> {
        self.known.get(name).or_else(|| self.proofs.variables.get(name))
    }

    fn atom(&mut self) -> Value {
        let word = self.next();
        match word {
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
                    fields.insert(name.to_owned(), value);
                    if self.peek() == ";" {
                        self.next();
                    }
                }
                self.expect("|}");
                Value::Record(fields)
            }
            "PI" => Value::Number(std::f64::consts::PI),
            name => match (self.variable(name), self.lets.get(name), name.parse()) {
                (Some(value), ..) => value.clone(),
                (_, Some(bound), _) => self.bound(bound, Vec::new()),
                (.., Ok(number)) => Value::Number(number),
                _ => self.proofs.applied(name, &[], self.known),
            },
        }
    }
}
