//! A statement's inequalities and equations.

use std::collections::BTreeMap;

/// A theorem's or a hypothesis' inequalities and equations, each as its sides, and its `let`s.
pub(super) struct Statement {
    pub file: String,
    pub relations: Vec<Vec<Vec<String>>>,
    pub lets: BTreeMap<String, Let>,
}

/// A term that a name stands for, with the arguments it takes.
#[derive(Debug)]
pub(super) struct Let {
    pub arguments: Vec<String>,
    pub term: Vec<String>,
}

/// The names in `(a b : R) (c : plane) : R`.
pub(super) fn arguments(words: &[String]) -> Vec<String> {
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
    pub fn parse(file: &str, words: &[String]) -> Self {
        let mut statement = Self { file: file.to_owned(), relations: Vec::new(), lets: BTreeMap::new() };
        statement.collect(words);
        statement
    }

    /// Takes in what these words state, whatever depends on what.
    fn collect(&mut self, words: &[String]) {
        let first = |sign: &str| outside(words).find(|&place| words[place] == sign);
        match words.first().map(String::as_str) {
            Some("forall" | "exists") => return self.collect(&words[first(",").expect("a quantifier ends") + 1..]),
            Some("let") => {
                let within = first("in").expect("let ends");
                let is = first(":=").expect("let binds");
                let bound = Let { arguments: words[2..is].to_vec(), term: words[is + 1..within].to_vec() };
                self.lets.insert(words[1].clone(), bound);
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
