//! Numbers as they were measured, computed and compared with as an audit does; `None` is unknown.

use core::cmp::Ordering;

#[cfg(all(target_arch = "x86", not(target_feature = "sse2")))]
compile_error!("floats are computed in their own precision: choose a target with SSE2");

/// A truth value; `None`: unknown.
pub type Truth = Option<bool>;

/// A number as it was measured: make it by `Number::from`. A NaN is unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    Single(f32),
    Double(f64),
    /// A whole number of 64 bits from 2^53 on.
    Whole(i128),
    /// A float that was chosen beside one: constants are to it what they are to that.
    Wide(f64),
}

macro_rules! of_small {
    ($($kind:ty),*) => {$(
        impl From<$kind> for Number {
            fn from(value: $kind) -> Self {
                Number::Double(f64::from(value))
            }
        }
    )*};
}

macro_rules! of_large {
    ($($kind:ty),*) => {$(
        impl From<$kind> for Number {
            fn from(value: $kind) -> Self {
                let whole = i128::from(value);
                if whole.unsigned_abs() < 1 << 53 {
                    Number::Double(value as f64)
                } else {
                    Number::Whole(whole)
                }
            }
        }
    )*};
}

of_small!(f64, bool, i8, u8, i16, u16, i32, u32);
of_large!(i64, u64);

impl From<f32> for Number {
    fn from(value: f32) -> Self {
        Number::Single(value)
    }
}

impl Number {
    fn value(self) -> f64 {
        match self {
            Number::Single(value) => f64::from(value),
            Number::Double(value) | Number::Wide(value) => value,
            Number::Whole(value) => value as f64,
        }
    }

    fn is_wide(self) -> bool {
        matches!(self, Number::Whole(_) | Number::Wide(_))
    }

    fn widened(self) -> Self {
        if self.is_wide() { self } else { Number::Wide(self.value()) }
    }
}

fn known(x: Option<Number>) -> Option<Number> {
    x.filter(|x| !x.value().is_nan())
}

/// As a 64-bit float.
fn plain(x: Option<Number>) -> Option<f64> {
    known(x).map(Number::value)
}

fn computed(value: f64) -> Option<Number> {
    known(Some(Number::Double(value)))
}

pub fn plus(x: Option<Number>, y: Option<Number>) -> Option<Number> {
    computed(plain(x)? + plain(y)?)
}

pub fn minus(x: Option<Number>, y: Option<Number>) -> Option<Number> {
    computed(plain(x)? - plain(y)?)
}

pub fn times(x: Option<Number>, y: Option<Number>) -> Option<Number> {
    computed(plain(x)? * plain(y)?)
}

/// Unknown where it divides by zero.
pub fn over(x: Option<Number>, y: Option<Number>) -> Option<Number> {
    let (x, y) = (plain(x)?, plain(y)?);
    if y == 0.0 { None } else { computed(x / y) }
}

/// With the sign of `y`; unknown where it divides by zero.
pub fn modulo(x: Option<Number>, y: Option<Number>) -> Option<Number> {
    let (x, y) = (plain(x)?, plain(y)?);
    let rest = x % y;
    computed(if rest != 0.0 && (rest < 0.0) != (y < 0.0) { rest + y } else { rest })
}

/// From left to right.
pub fn power(x: Option<Number>, times: u32) -> Option<Number> {
    let x = plain(x)?;
    computed((1..times).fold(x, |power, _| power * x))
}

pub fn in_base(x: Option<Number>, numerator: f64, denominator: f64) -> Option<Number> {
    computed(plain(x)? * numerator / denominator)
}

pub fn negative(x: Option<Number>) -> Option<Number> {
    x.map(|x| match x {
        Number::Single(value) => Number::Single(-value),
        Number::Double(value) => Number::Double(-value),
        Number::Whole(value) => Number::Whole(-value),
        Number::Wide(value) => Number::Wide(-value),
    })
}

pub fn absolute(x: Option<Number>) -> Option<Number> {
    if x?.value() < 0.0 { negative(x) } else { x }
}

/// A NaN is equal to none.
fn order(x: Number, y: Number) -> Ordering {
    match (x, y) {
        (Number::Whole(x), Number::Whole(y)) => x.cmp(&y),
        // A float is whole where whole numbers of this size are.
        (Number::Whole(x), y) => x.cmp(&(y.value() as i128)),
        (x, Number::Whole(y)) => (x.value() as i128).cmp(&y),
        (x, y) => x.value().partial_cmp(&y.value()).unwrap_or(Ordering::Greater),
    }
}

/// How two numbers are to each other, as `Ordering::is_lt`.
pub type Sign = fn(Ordering) -> bool;

pub fn compared(x: Option<Number>, sign: Sign, y: Option<Number>) -> Truth {
    Some(sign(order(known(x)?, known(y)?)))
}

/// Beside a constant: the number that stands for it beside 32-bit floats, 64-bit floats, and wide numbers.
pub fn compared_with(x: Option<Number>, sign: Sign, single: f64, double: f64, wide: Number) -> Truth {
    let x = known(x)?;
    let fixed = match x {
        Number::Single(_) => Number::Double(single),
        Number::Double(_) => Number::Double(double),
        Number::Whole(_) | Number::Wide(_) => wide,
    };
    Some(sign(order(x, fixed)))
}

/// One of two numbers, as a number of the kind that holds both.
fn one_of(x: Option<Number>, y: Option<Number>, first: Ordering) -> Option<Number> {
    let (x, y) = (known(x)?, known(y)?);
    let order = order(x, y);
    let chosen = if order == Ordering::Equal || order == first { x } else { y };
    Some(match (x, y) {
        _ if x.is_wide() || y.is_wide() => chosen.widened(),
        (Number::Single(_), Number::Single(_)) => chosen,
        _ => Number::Double(chosen.value()),
    })
}

pub fn lesser(x: Option<Number>, y: Option<Number>) -> Option<Number> {
    one_of(x, y, Ordering::Less)
}

pub fn greater(x: Option<Number>, y: Option<Number>) -> Option<Number> {
    one_of(x, y, Ordering::Greater)
}

/// Beside a constant: wide numbers become 64-bit floats first.
fn one_with(x: Option<Number>, single: Number, double: f64, first: Ordering) -> Option<Number> {
    let x = x?;
    match x {
        Number::Single(_) => one_of(Some(x), Some(single), first),
        _ => one_of(Some(Number::Double(x.value())), Some(Number::Double(double)), first),
    }
}

pub fn lesser_with(x: Option<Number>, single: Number, double: f64) -> Option<Number> {
    one_with(x, single, double, Ordering::Less)
}

pub fn greater_with(x: Option<Number>, single: Number, double: f64) -> Option<Number> {
    one_with(x, single, double, Ordering::Greater)
}

/// A number as a truth value: 1 is true, 0 is false.
pub fn flag(x: Option<Number>) -> Truth {
    let value = plain(x)?;
    if value == 0.0 {
        Some(false)
    } else if value == 1.0 {
        Some(true)
    } else {
        None
    }
}

pub fn negated(x: Truth) -> Truth {
    x.map(|x| !x)
}

pub fn both(x: Truth, y: Truth) -> Truth {
    match (x, y) {
        (Some(false), _) | (_, Some(false)) => Some(false),
        (Some(true), Some(true)) => Some(true),
        _ => None,
    }
}

pub fn either(x: Truth, y: Truth) -> Truth {
    negated(both(negated(x), negated(y)))
}

pub fn same(x: Truth, y: Truth) -> Truth {
    Some(x? == y?)
}

/// What an element means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    Measured,
    Drop,
    Far,
    Near,
    Unknown,
}

/// What NaN, +inf, -inf and a number that is not valid mean.
pub type Invalid = [Meaning; 4];

fn meaning(x: Number, valid: impl Fn(Option<Number>) -> Truth, invalid: Invalid) -> Meaning {
    let [nan, above, below, other] = invalid;
    let value = x.value();
    if value.is_nan() {
        nan
    } else if value == f64::INFINITY {
        above
    } else if value == f64::NEG_INFINITY {
        below
    } else if valid(Some(x)) == Some(true) {
        Meaning::Measured
    } else {
        other
    }
}

/// The number that an element with this meaning stands for.
fn meant(x: Number, meaning: Meaning) -> Option<Number> {
    match meaning {
        Meaning::Measured => Some(x),
        Meaning::Far => Some(endless(x, f32::INFINITY)),
        Meaning::Near => Some(endless(x, f32::NEG_INFINITY)),
        Meaning::Drop | Meaning::Unknown => None,
    }
}

/// Infinity as it is recorded beside a number.
fn endless(x: Number, end: f32) -> Number {
    match x {
        Number::Single(_) => Number::Single(end),
        _ => Number::Double(f64::from(end)),
    }
}

/// What was chosen of an array, as it is recorded.
fn recorded(x: Number) -> Number {
    match x {
        Number::Wide(value) => Number::Double(value),
        _ => x,
    }
}

/// The number of a message's field.
pub fn measured(x: Option<Number>, valid: impl Fn(Option<Number>) -> Truth, invalid: Invalid) -> Option<Number> {
    let x = x?;
    meant(x, meaning(x, valid, invalid)).map(recorded)
}

/// The least or the greatest element. All are wide where one is a whole number from 2^53 on.
pub fn reduced<T: Copy + Into<Number>>(
    field: &[T],
    choose: fn(Option<Number>, Option<Number>) -> Option<Number>,
    valid: impl Fn(Option<Number>) -> Truth,
    invalid: Invalid,
) -> Option<Number> {
    let is_wide = field.iter().any(|each| (*each).into().is_wide());
    let mut found = None;
    for each in field {
        let x = if is_wide { (*each).into().widened() } else { (*each).into() };
        let meaning = meaning(x, &valid, invalid);
        if meaning == Meaning::Unknown {
            return None;
        }
        if meaning != Meaning::Drop {
            let x = meant(x, meaning);
            found = if found.is_some() { choose(found, x) } else { x };
        }
    }
    found.map(recorded)
}

/// A number with the nanosecond in which it was measured; `None`: none has come, or it is unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    pub number: Option<Number>,
    pub at: i64,
}

/// The number of a sample that has come and is not too old; without a limit its age does not count.
pub fn in_force(sample: Sample, now: i64, max_age: Option<u64>) -> Option<Number> {
    let is_old = max_age.is_some_and(|most| now.abs_diff(sample.at) > most);
    if now < sample.at || is_old { None } else { known(sample.number) }
}
