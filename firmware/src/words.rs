//! Enumerations whose variants each have words for the operator.

/// An enumeration, and its display: each variant with its words.
macro_rules! worded {
    ($(#[$meta:meta])* $visible:vis enum $name:ident { $($(#[$meaning:meta])+ $variant:ident = $text:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $visible enum $name {
            $($(#[$meaning])+ $variant,)+
        }

        impl core::fmt::Display for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str(match self { $(Self::$variant => $text,)+ })
            }
        }
    };
}

pub(crate) use worded;
