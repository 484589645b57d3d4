//! What turns the tables of [`super`] into types.

/// The views: one for each task, made of a reference to the values.
macro_rules! views {
    ($($(#[$doc:meta])* $view:ident = $of:ident;)*) => {
        $($(#[$doc])*
        pub struct $view<'a, M: RawMutex>(&'a Values<M>);

        impl<M: RawMutex> Clone for $view<'_, M> {
            fn clone(&self) -> Self {
                *self
            }
        }

        impl<M: RawMutex> Copy for $view<'_, M> {}

        offers! { [M: RawMutex] $view<'_, M> { fn announce(event: Event); } })*

        impl<M: RawMutex> Shared<M> {
            $(#[doc = concat!("[`", stringify!($view), "`] of all this.")]
            pub const fn $of(&self) -> $view<'_, M> {
                $view(&self.0)
            })*
        }
    };
}

/// The values, and a method of each view for each of those that it has access to.
macro_rules! values {
    ($($(#[$doc:meta])* $visible:vis $field:ident: $type:ty { $($access:ident: $($view:ident),+);* })*) => {
        /// Everything that passes between tasks. No task has it; each has a view of it.
        pub struct Values<M: RawMutex> {
            $($(#[$doc])*
            $(#[doc = concat!("\n\n", stringify!($access), ":" $(, " [`", stringify!($view), "`]")+)])*
            $visible $field: $type,)*
        }

        impl<M: RawMutex> Values<M> {
            const fn new() -> Self {
                Self { $($field: <$type>::new(),)* }
            }
        }

        $($($(impl<'a, M: RawMutex> $view<'a, M> {
            #[doc = concat!("[`", stringify!($access), "`] access to [`Values::", stringify!($field), "`].")]
            pub fn $field(self) -> $access<'a, $type> {
                (&self.0.$field).into()
            }
        })+)*)*
    };
}

/// Which methods of what it refers to an access, or a view, offers.
macro_rules! offers {
    ($([$($generic:tt)*] $type:ty {
        $(fn $method:ident($($argument:ident: $of:ty),*) $(-> $result:ty)?;)*
    })*) => {
        $(impl<$($generic)*> $type {
            $(#[doc = concat!("`", stringify!($method), "`, as what this refers to has it.")]
            pub fn $method(self, $($argument: $of),*) $(-> $result)? {
                self.0.$method($($argument),*)
            })*
        })*
    };
}

pub(super) use {offers, values, views};
