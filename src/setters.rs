//! The builder methods that set one field, of the builder itself or of a copy.

/// Inside an `impl`: for each doc comment and line `with_x(x: X) => field = value;` a public method
/// that sets the field and returns the builder.
macro_rules! setters {
    ($(
        $(#[$doc:meta])*
        $name:ident($($argument:ident: $type:ty),*) => $($field:ident).+ = $value:expr;
    )*) => {$(
        $(#[$doc])*
        #[must_use]
        pub fn $name(mut self, $($argument: $type),*) -> Self {
            self.$($field).+ = $value;
            self
        }
    )*};
}

/// As [`setters!`], for methods that leave the original as it is and return a changed copy.
macro_rules! changed_copies {
    ($(
        $(#[$doc:meta])*
        $name:ident($($argument:ident: $type:ty),*) => $($field:ident).+ = $value:expr;
    )*) => {$(
        $(#[$doc])*
        #[must_use]
        pub fn $name(&self, $($argument: $type),*) -> Self {
            let mut copy = self.clone();
            copy.$($field).+ = $value;
            copy
        }
    )*};
}

pub(crate) use {changed_copies, setters};
