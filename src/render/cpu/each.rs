//! Small arrays, element by element. `array::map` stays a call where its caller is long, which costs rays a quarter of
//! their time; this is always inlined.

/// An array whose elements are turned into others.
pub trait Each {
    /// An element.
    type Item;
    /// As many elements of another type.
    type Of<T>;

    /// What `of` makes of each element, in order.
    fn each<T>(self, of: impl FnMut(Self::Item) -> T) -> Self::Of<T>;
}

impl<I> Each for [I; 2] {
    type Item = I;
    type Of<T> = [T; 2];

    #[inline(always)]
    fn each<T>(self, mut of: impl FnMut(I) -> T) -> [T; 2] {
        let [a, b] = self;
        [of(a), of(b)]
    }
}

impl<I> Each for [I; 3] {
    type Item = I;
    type Of<T> = [T; 3];

    #[inline(always)]
    fn each<T>(self, mut of: impl FnMut(I) -> T) -> [T; 3] {
        let [a, b, c] = self;
        [of(a), of(b), of(c)]
    }
}

impl<I> Each for [I; 4] {
    type Item = I;
    type Of<T> = [T; 4];

    #[inline(always)]
    fn each<T>(self, mut of: impl FnMut(I) -> T) -> [T; 4] {
        let [a, b, c, d] = self;
        [of(a), of(b), of(c), of(d)]
    }
}
