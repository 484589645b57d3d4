//! Definitions and statements of `proofs/*.v`, evaluated in double precision: what Coq proves something of is what the
//! code computes.
//!
//! It reads the terms that those files use: numbers, `+ - * /`, `sqrt`, `exp`, `Rabs`, `Rmax`, `Rmin`, `rnd` (to single
//! precision), records with their fields, `if R…_dec … then … else …`, `fold_right (fun …)`, and other definitions, those of the files they
//! require too. Of a statement it evaluates the sides of each inequality and equation, premises and conclusions alike.
//! Variables of a section, and what a statement is for all of, are given by the caller. Whatever is evaluated is noted:
//! [`compared`].

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::rc::Rc;

/// Where the proofs are.
pub const PROOFS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../proofs");

thread_local! {
    static COMPARED: RefCell<BTreeSet<String>> = const { RefCell::new(BTreeSet::new()) };
    static READ: RefCell<BTreeMap<String, Rc<Contents>>> = const { RefCell::new(BTreeMap::new()) };
}

/// What this thread has evaluated, as `File.name`.
pub fn compared() -> BTreeSet<String> {
    COMPARED.with_borrow(Clone::clone)
}

pub(super) fn note(file: &str, name: &str) {
    COMPARED.with_borrow_mut(|compared| compared.insert(format!("{file}.{name}")));
}

/// What a term is.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Number(f64),
    Record(BTreeMap<String, Value>),
    List(Vec<Value>),
    /// A function of time, at the instant at hand.
    Moving(f64),
}

impl Value {
    pub fn number(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            _ => panic!("{self:?} is no number"),
        }
    }

    /// The record of these fields.
    pub fn record(fields: &[(&str, f64)]) -> Self {
        Self::Record(fields.iter().map(|(name, x)| ((*name).to_owned(), Self::Number(*x))).collect())
    }
}

/// A definition: the file it is in, its arguments, its term, and whether each of its steps is rounded to single
/// precision.
pub(super) struct Definition {
    pub file: String,
    pub arguments: Vec<String>,
    pub term: Vec<String>,
    pub rounded: bool,
}

/// A theorem's or a hypothesis' inequalities and equations, each as its sides, and its `let`s.
struct Statement {
    file: String,
    relations: Vec<Vec<Vec<String>>>,
    lets: BTreeMap<String, Vec<String>>,
}

/// The definitions and statements of a file and of those it requires.
#[derive(Default)]
struct Contents {
    definitions: BTreeMap<String, Definition>,
    statements: BTreeMap<String, Statement>,
}

/// A file's definitions and statements, with variables.
#[derive(Clone)]
pub struct Proofs {
    contents: Rc<Contents>,
    variables: BTreeMap<String, Value>,
}

impl Contents {
    fn add(&mut self, file: &str) {
        for sentence in sentences(file) {
            let [keyword, name, rest @ ..] = sentence.as_slice() else { continue };
            let (file, name) = (file.to_owned(), name.clone());
            match keyword.as_str() {
                "From" if name == "SaturatedHybrid" => rest.iter().skip(2).for_each(|file| self.add(file)),
                "Definition" => {
                    let is = rest.iter().position(|word| word == ":=").expect("a definition has a term");
                    let (arguments, term) = (arguments(&rest[..is]), rest[is + 1..].to_vec());
                    if rest[..is].ends_with(&["Prop".to_owned()]) {
                        self.statements.insert(name.clone(), Statement::of(&file, &term));
                    }
                    self.definitions.insert(name, Definition { file, arguments, term, rounded: false });
                }
                "Theorem" | "Hypothesis" => {
                    self.statements.insert(name, Statement::of(&file, &rest[1..]));
                }
                _ => {}
            }
        }
    }
}

impl Proofs {
    /// Of `proofs/<file>.v` and the files it requires.
    pub fn read(file: &str) -> Self {
        let known = READ.with_borrow(|read| read.get(file).cloned());
        let contents = known.unwrap_or_else(|| {
            let mut contents = Contents::default();
            contents.add(file);
            let contents = Rc::new(contents);
            READ.with_borrow_mut(|read| read.insert(file.to_owned(), contents.clone()));
            contents
        });
        Self { contents, variables: BTreeMap::new() }
    }

    /// Of these definitions.
    pub(super) fn of(definitions: BTreeMap<String, Definition>) -> Self {
        let contents = Rc::new(Contents { definitions, ..Contents::default() });
        Self { contents, variables: BTreeMap::new() }
    }

    /// The names of its definitions.
    pub(super) fn defined(&self) -> impl Iterator<Item = &String> {
        self.contents.definitions.keys()
    }

    /// With variables of its sections, or those that a statement is for all of.
    pub fn with(mut self, variables: &[(&str, f64)]) -> Self {
        self.variables.extend(variables.iter().map(|(name, x)| ((*name).to_owned(), Value::Number(*x))));
        self
    }

    /// With a variable that is no number.
    pub fn with_value(mut self, name: &str, value: Value) -> Self {
        self.variables.insert(name.to_owned(), value);
        self
    }

    /// A definition of these arguments.
    pub fn value(&self, name: &str, arguments: &[Value]) -> Value {
        let definition = self.contents.definitions.get(name).unwrap_or_else(|| panic!("no definition {name}"));
        let Definition { file, arguments: names, term, rounded } = definition;
        note(file, name);
        assert_eq!(names.len(), arguments.len(), "{name}");
        let mut known = self.variables.clone();
        known.extend(names.iter().cloned().zip(arguments.iter().cloned()));
        Reader { proofs: self, known: &known, lets: &BTreeMap::new(), words: term, at: 0, rounded: *rounded }.whole()
    }

    /// The same of numbers.
    pub fn number(&self, name: &str, arguments: &[f64]) -> f64 {
        self.value(name, &arguments.iter().map(|x| Value::Number(*x)).collect::<Vec<_>>()).number()
    }

    /// The sides of the one inequality or equation of a statement in which these words stand.
    pub fn sides(&self, name: &str, standing: &str) -> Vec<f64> {
        let statement = self.statement(name);
        let text = |words: &[String]| format!(" {} ", words.join(" "));
        let standing = text(&words(standing));
        let all = statement.relations.iter().map(|sides| (sides, text(&sides.join(&[][..]))));
        let meant: Vec<_> = all.filter(|(_, relation)| relation.contains(&standing)).collect();
        let [(sides, _)] = meant.as_slice() else { panic!("{name}: {} relations with{standing}", meant.len()) };
        // Of a relation's sides every other is its sign.
        sides.iter().step_by(2).map(|side| self.read_in(statement, side).number()).collect()
    }

    /// What a statement's `let` binds.
    pub fn bound(&self, name: &str, variable: &str) -> f64 {
        let statement = self.statement(name);
        self.read_in(statement, &statement.lets[variable]).number()
    }

    fn statement(&self, name: &str) -> &Statement {
        let statement = self.contents.statements.get(name).unwrap_or_else(|| panic!("no statement {name}"));
        note(&statement.file, name);
        statement
    }

    fn read_in(&self, statement: &Statement, term: &[String]) -> Value {
        let lets = &statement.lets;
        Reader { proofs: self, known: &self.variables, lets, words: term, at: 0, rounded: false }.whole()
    }
}

/// The names of everything that `proofs/<file>.v` defines, and of its theorems.
pub fn names(file: &str) -> Vec<String> {
    let named = |sentence: Vec<String>| match sentence.as_slice() {
        [keyword, name, ..] if matches!(keyword.as_str(), "Definition" | "Theorem") => Some(name.clone()),
        _ => None,
    };
    sentences(file).into_iter().filter_map(named).collect()
}

fn sentences(file: &str) -> Vec<Vec<String>> {
    let path = format!("{PROOFS}/{file}.v");
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    words(&without_comments(&text)).split(|word| word == ".").map(<[String]>::to_vec).collect()
}

fn without_comments(text: &str) -> String {
    let mut parts = text.split("(*");
    let first = parts.next().unwrap_or_default().to_owned();
    first + &parts.map(|part| part.split_once("*)").expect("comments do not nest").1).collect::<String>()
}

/// The signs of more than one character, longer ones first.
const SIGNS: [&str; 10] = ["<->", ":=", "{|", "|}", "->", "=>", "/\\", "<=", ">=", "<>"];

/// Words and signs; a full stop ends a sentence.
pub(super) fn words(text: &str) -> Vec<String> {
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

/// The places of words that are in no parentheses.
fn outside(words: &[String]) -> impl Iterator<Item = usize> + '_ {
    let mut depth = 0;
    words.iter().enumerate().filter_map(move |(place, word)| {
        depth -= i32::from(word == ")");
        let at_top = depth == 0;
        depth += i32::from(word == "(");
        at_top.then_some(place)
    })
}

fn is_relation(word: &str) -> bool {
    matches!(word, "<=" | "<" | "=" | ">=" | ">" | "<>")
}

impl Statement {
    fn of(file: &str, words: &[String]) -> Self {
        let mut statement = Self { file: file.to_owned(), relations: Vec::new(), lets: BTreeMap::new() };
        statement.collect(words);
        statement
    }

    /// Takes in what these words state, whatever depends on what.
    fn collect(&mut self, words: &[String]) {
        let first = |sign: &str| outside(words).find(|&place| words[place] == sign);
        match words.first().map(String::as_str) {
            Some("forall") => return self.collect(&words[first(",").expect("forall ends") + 1..]),
            Some("let") => {
                let within = first("in").expect("let ends");
                self.lets.insert(words[1].clone(), words[3..within].to_vec());
                return self.collect(&words[within + 1..]);
            }
            _ => {}
        }
        if let Some(place) = outside(words).find(|&place| matches!(words[place].as_str(), "->" | "<->" | "/\\")) {
            self.collect(&words[..place]);
            return self.collect(&words[place + 1..]);
        }
        let signs: Vec<usize> = outside(words).filter(|&place| is_relation(&words[place])).collect();
        if signs.is_empty() {
            // One in parentheses, or no relation.
            if let [open, inner @ .., close] = words
                && open == "("
                && close == ")"
            {
                self.collect(inner);
            }
            return;
        }
        let (mut sides, mut from) = (Vec::new(), 0);
        for sign in signs {
            sides.extend([words[from..sign].to_vec(), vec![words[sign].clone()]]);
            from = sign + 1;
        }
        sides.push(words[from..].to_vec());
        self.relations.push(sides);
    }
}

struct Reader<'a> {
    proofs: &'a Proofs,
    known: &'a BTreeMap<String, Value>,
    lets: &'a BTreeMap<String, Vec<String>>,
    words: &'a [String],
    at: usize,
    rounded: bool,
}

impl Reader<'_> {
    /// The term from its first word to its last.
    fn whole(mut self) -> Value {
        let value = self.sum();
        assert_eq!(self.at, self.words.len(), "{:?} is not understood", &self.words[self.at..]);
        value
    }

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
            "fold_right" => self.fold(),
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

    /// `fold_right (fun element rest => …) start list`.
    fn fold(&mut self) -> Value {
        self.expect("fold_right");
        self.expect("(");
        self.expect("fun");
        let [element, rest] = [self.next(), self.next()];
        self.expect("=>");
        // The parenthesis that closes it brings the depth below that of its body.
        let mut depth = 0;
        let closes = |word: &String| {
            depth += i32::from(word == "(") - i32::from(word == ")");
            depth < 0
        };
        let end = self.at + self.words[self.at..].iter().position(closes).expect("the function ends");
        let body = &self.words[self.at..end];
        self.at = end + 1;
        let (start, Value::List(list)) = (self.atom(), self.atom()) else { panic!("a list is folded") };
        list.into_iter().rev().fold(start, |folded, value| {
            let mut known = self.known.clone();
            known.extend([(element.clone(), value), (rest.clone(), folded)]);
            Reader { known: &known, words: body, at: 0, ..*self }.whole()
        })
    }

    /// A name with its arguments, or an atom.
    fn application(&mut self) -> Value {
        let name = self.peek().to_owned();
        let defined = self.proofs.contents.definitions.get(&name);
        let count = match name.as_str() {
            "sqrt" | "exp" | "Rabs" | "rnd" => 1,
            "Rmax" | "Rmin" => 2,
            _ => match self.known.get(&name) {
                Some(Value::Moving(_)) => 1,
                Some(_) => 0,
                None if self.lets.contains_key(&name) => 0,
                None => match defined {
                    Some(definition) => definition.arguments.len(),
                    None if name.starts_with(|sign: char| sign.is_alphabetic()) => 1,
                    None => 0,
                },
            },
        };
        if count == 0 {
            return self.atom();
        }
        self.next();
        let arguments: Vec<Value> = (0..count).map(|_| self.atom()).collect();
        let numbers = || arguments.iter().map(Value::number).collect::<Vec<f64>>();
        match (name.as_str(), self.known.get(&name), arguments.first()) {
            ("sqrt", ..) => self.step(numbers()[0].sqrt()),
            ("exp", ..) => Value::Number(numbers()[0].exp()),
            ("Rabs", ..) => Value::Number(numbers()[0].abs()),
            ("rnd", ..) => Value::Number(f64::from(numbers()[0] as f32)),
            ("Rmax", ..) => Value::Number(numbers()[0].max(numbers()[1])),
            ("Rmin", ..) => Value::Number(numbers()[0].min(numbers()[1])),
            (_, Some(Value::Moving(now)), _) => Value::Number(*now),
            (_, _, Some(Value::Record(fields))) if defined.is_none() => fields[&name].clone(),
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
            name => match (self.known.get(name), self.lets.get(name), name.parse()) {
                (Some(value), ..) => value.clone(),
                (_, Some(term), _) => Reader { words: term, at: 0, ..*self }.whole(),
                (.., Ok(number)) => Value::Number(number),
                _ => self.proofs.value(name, &[]),
            },
        }
    }
}
