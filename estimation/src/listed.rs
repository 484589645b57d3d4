//! Enumerations with a list of their variants, and a text for each: each variant is written once.

/// An enumeration with `ALL`, every variant in the order written.
#[macro_export]
macro_rules! listed {
    ($(#[$meta:meta])* pub enum $name:ident { $($(#[$meaning:meta])+ $variant:ident,)+ }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name {
            $($(#[$meaning])+ $variant,)+
        }

        impl $name {
            /// Every one.
            pub const ALL: [Self; [$(Self::$variant),+].len()] = [$(Self::$variant),+];
        }
    };
}

/// The same, each variant with its words.
#[macro_export]
macro_rules! worded {
    ($(#[$meta:meta])* pub enum $name:ident { $($(#[$meaning:meta])+ $variant:ident = $text:literal,)+ }) => {
        $crate::listed! {
            $(#[$meta])*
            #[cfg_attr(feature = "defmt", derive(defmt::Format))]
            pub enum $name { $($(#[$meaning])+ $variant,)+ }
        }

        impl $name {
            /// The same in words.
            pub const fn text(self) -> &'static str {
                match self { $(Self::$variant => $text,)+ }
            }
        }

        impl core::fmt::Display for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str(self.text())
            }
        }
    };
}
