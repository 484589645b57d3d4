//! How a check comes out.

/// How a check came out, and with which figures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// As it must.
    Passed(String),
    /// Not so: why.
    Failed(String),
    /// It was not made: why.
    Skipped(String),
}

impl Outcome {
    /// In a word.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Passed(_) => "passed",
            Self::Failed(_) => "FAILED",
            Self::Skipped(_) => "skipped",
        }
    }

    /// Its figures, or its reason.
    #[must_use]
    pub fn figures(&self) -> &str {
        match self {
            Self::Passed(figures) | Self::Failed(figures) | Self::Skipped(figures) => figures,
        }
    }

    /// One of this word, with its figures.
    pub(super) fn read(word: &str, figures: String) -> Option<Self> {
        [Self::Passed, Self::Failed, Self::Skipped]
            .map(|of| of(figures.clone()))
            .into_iter()
            .find(|it| it.word() == word)
    }
}
