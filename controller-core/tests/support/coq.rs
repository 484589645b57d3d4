//! Definitions and statements of `proofs/*.v`, evaluated in double precision: what Coq proves something of is what the
//! code computes.
//!
//! It reads the terms that those files use: numbers, `+ - * /`, functions of the library, records with their fields,
//! `if R…_dec … then … else …`, `let`, `fold_right (fun …)`, and other definitions, those of the files they require
//! too. From a statement it evaluates the sides of each inequality and equation, premises and conclusions alike. The
//! caller gives a section's variables, and those that a statement quantifies over. Outside its section a definition
//! takes the variables that it uses as arguments, before its own. Whatever is evaluated is noted: [`compared`].

mod reader;
mod statement;
mod text;

use reader::Reader;
use statement::{Statement, arguments};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::rc::Rc;
use text::without_comments;
pub(super) use text::words;

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
    /// A function, of time most often, at the instant at hand.
    Moving(Box<Value>),
}

impl Value {
    pub fn number(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            _ => panic!("{self:?} is not a number"),
        }
    }

    /// A function that has this value at the instant at hand.
    pub fn moving(self) -> Self {
        Self::Moving(Box::new(self))
    }

    /// The record of these fields.
    pub fn record(fields: &[(&str, f64)]) -> Self {
        Self::Record(fields.iter().map(|(name, x)| ((*name).to_owned(), Self::Number(*x))).collect())
    }
}

/// A definition: the file it is in, the variables of its sections that it uses, its arguments, its term, and whether
/// each of its steps is rounded to single precision.
pub(super) struct Definition {
    pub file: String,
    pub variables: Vec<String>,
    pub arguments: Vec<String>,
    pub term: Vec<String>,
    pub rounded: bool,
}

/// A section that is open: its variables, and which variables each of its definitions uses, of its own and of the
/// sections around it.
#[derive(Default)]
struct Section {
    variables: Vec<String>,
    used: BTreeMap<String, Vec<String>>,
}

/// Which of the variables of the open sections these words use.
fn used(sections: &[Section], words: &[String]) -> Vec<String> {
    let through = sections.iter().flat_map(|section| words.iter().filter_map(|word| section.used.get(word))).flatten();
    let used: BTreeSet<&String> = words.iter().chain(through).collect();
    sections.iter().flat_map(|section| &section.variables).filter(|name| used.contains(name)).cloned().collect()
}

/// The definitions and statements of a file and of those it requires.
#[derive(Default)]
struct Contents {
    files: BTreeSet<String>,
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
        if !self.files.insert(file.to_owned()) {
            return;
        }
        let mut sections = vec![Section::default()];
        for sentence in sentences(file) {
            let [keyword, name, rest @ ..] = sentence.as_slice() else { continue };
            let (file, name) = (file.to_owned(), name.clone());
            match keyword.as_str() {
                "From" if name == "SaturatedHybrid" => rest.iter().skip(2).for_each(|file| self.add(file)),
                "Section" => sections.push(Section::default()),
                "End" => drop(sections.pop()),
                "Variable" => sections.last_mut().expect("a section").variables.push(name),
                "Variables" => sections.last_mut().expect("a section").variables.extend(arguments(&sentence)),
                "Definition" | "Let" => {
                    let Some(is) = rest.iter().position(|word| word == ":=") else { continue };
                    let (arguments, term) = (arguments(&rest[..is]), rest[is + 1..].to_vec());
                    let variables = used(&sections, &term);
                    sections.last_mut().expect("a section").used.insert(name.clone(), variables.clone());
                    if keyword == "Let" {
                        continue;
                    }
                    if rest[..is].ends_with(&["Prop".to_owned()]) {
                        self.statements.insert(name.clone(), Statement::parse(&file, &term));
                    }
                    self.definitions.insert(name, Definition { file, variables, arguments, term, rounded: false });
                }
                "Theorem" | "Hypothesis" => {
                    self.statements.insert(name, Statement::parse(&file, &rest[1..]));
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
    pub(super) fn from_definitions(definitions: BTreeMap<String, Definition>) -> Self {
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

    /// With a variable that is not a number.
    pub fn with_value(mut self, name: &str, value: Value) -> Self {
        self.variables.insert(name.to_owned(), value);
        self
    }

    /// A definition of these arguments.
    pub fn value(&self, name: &str, arguments: &[Value]) -> Value {
        self.applied(name, arguments, &BTreeMap::new())
    }

    /// The part of a definition's term that is in parentheses and begins with these words.
    pub fn part(&self, name: &str, given: &[f64], begins: &str) -> f64 {
        let term = &self.contents.definitions[name].term;
        let begins = words(begins);
        let mut places = (1..term.len()).filter(|&at| term[at - 1] == "(" && term[at..].starts_with(&begins));
        let (Some(place), None) = (places.next(), places.next()) else { panic!("{name}: one part with {begins:?}") };
        let given: Vec<Value> = given.iter().map(|x| Value::Number(*x)).collect();
        self.read_in(name, &given, &BTreeMap::new(), |reader| reader.parenthesis(place)).number()
    }

    /// A definition, where the caller knows what the variables of its section are.
    fn applied(&self, name: &str, given: &[Value], caller: &BTreeMap<String, Value>) -> Value {
        self.read_in(name, given, caller, |reader| reader.whole())
    }

    fn read_in(
        &self,
        name: &str,
        given: &[Value],
        caller: &BTreeMap<String, Value>,
        read: impl FnOnce(Reader) -> Value,
    ) -> Value {
        let definition = self.contents.definitions.get(name).unwrap_or_else(|| panic!("no definition {name}"));
        let Definition { file, variables, arguments, term, rounded } = definition;
        note(file, name);
        let mut known = BTreeMap::new();
        let own = given.len().checked_sub(arguments.len()).unwrap_or_else(|| panic!("{name}: too few arguments"));
        if own == 0 {
            let of_caller = variables.iter().filter_map(|name| Some((name.clone(), caller.get(name)?.clone())));
            known.extend(of_caller);
        } else {
            assert_eq!(variables.len(), own, "{name}: {variables:?}");
            known.extend(variables.iter().cloned().zip(given.iter().cloned()));
        }
        known.extend(arguments.iter().cloned().zip(given[own..].iter().cloned()));
        read(Reader { proofs: self, known: &known, lets: &BTreeMap::new(), words: term, at: 0, rounded: *rounded })
    }

    fn defines(&self, name: &str) -> bool {
        self.contents.definitions.contains_key(name)
    }

    /// The same of numbers.
    pub fn number(&self, name: &str, arguments: &[f64]) -> f64 {
        self.value(name, &arguments.iter().map(|x| Value::Number(*x)).collect::<Vec<_>>()).number()
    }

    /// The sides of the one inequality or equation of a statement in which these words stand.
    pub fn sides(&self, name: &str, standing: &str) -> Vec<f64> {
        self.sides_of(name, standing).iter().map(Value::number).collect()
    }

    /// The same of an equation of vectors, too.
    pub fn sides_of(&self, name: &str, standing: &str) -> Vec<Value> {
        let statement = self.statement(name);
        let text = |words: &[String]| format!(" {} ", words.join(" "));
        let standing = text(&words(standing));
        let all = statement.relations.iter().map(|sides| (sides, text(&sides.join(&[][..]))));
        let meant: Vec<_> = all.filter(|(_, relation)| relation.contains(&standing)).collect();
        let [(sides, _)] = meant.as_slice() else { panic!("{name}: {} relations with{standing}", meant.len()) };
        // Of a relation's sides every other is its sign.
        sides.iter().step_by(2).map(|side| self.reader(statement, side).whole()).collect()
    }

    /// What a statement's `let` binds.
    pub fn bound(&self, name: &str, variable: &str) -> f64 {
        self.bound_of(name, variable, &[])
    }

    /// The same of these arguments.
    pub fn bound_of(&self, name: &str, variable: &str, arguments: &[f64]) -> f64 {
        let statement = self.statement(name);
        let arguments = arguments.iter().map(|x| Value::Number(*x)).collect();
        self.reader(statement, &[]).bound(&statement.lets[variable], arguments).number()
    }

    fn statement(&self, name: &str) -> &Statement {
        let statement = self.contents.statements.get(name).unwrap_or_else(|| panic!("no statement {name}"));
        note(&statement.file, name);
        statement
    }

    fn reader<'a>(&'a self, statement: &'a Statement, words: &'a [String]) -> Reader<'a> {
        const NOTHING: &BTreeMap<String, Value> = &BTreeMap::new();
        Reader { proofs: self, known: NOTHING, lets: &statement.lets, words, at: 0, rounded: false }
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
