//! The one place that knows whether there are threads.

/// Runs both and waits for both; side by side where there are threads.
#[cfg(feature = "parallel")]
pub(crate) fn join<A: Send, B: Send>(
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    rayon::join(first, second)
}

/// Runs one after the other.
#[cfg(not(feature = "parallel"))]
pub(crate) fn join<A, B>(first: impl FnOnce() -> A, second: impl FnOnce() -> B) -> (A, B) {
    (first(), second())
}

/// A piece of work. Whatever it does it is of one type, and [`fill_chunks`] and [`map_chunks`] call what they are given through a
/// pointer: what hands work to threads is then compiled once, and not for each caller, which took a third of the crate's code.
#[cfg(feature = "parallel")]
type Work<'a> = Box<dyn FnOnce() + Send + 'a>;

/// Runs all of it side by side, and waits for all.
#[cfg(feature = "parallel")]
fn run(work: Vec<Work<'_>>) {
    use rayon::prelude::*;
    work.into_par_iter().for_each(|work| work());
}

/// Fills `output` in chunks of at most `chunk` elements; `fill` gets the index of its chunk's first element.
#[cfg(feature = "parallel")]
pub(crate) fn fill_chunks<T: Send>(output: &mut [T], chunk: usize, fill: impl Fn(usize, &mut [T]) + Sync) {
    fill_parts(output, chunk, &fill);
}

#[cfg(feature = "parallel")]
fn fill_parts<T: Send>(output: &mut [T], chunk: usize, fill: &(dyn Fn(usize, &mut [T]) + Sync)) {
    let parts = output.chunks_mut(chunk);
    if parts.len() <= 1 {
        return parts.for_each(|part| fill(0, part));
    }
    let work = |(index, part)| -> Work<'_> { Box::new(move || fill(index * chunk, part)) };
    run(parts.enumerate().map(work).collect());
}

/// Fills `output` in chunks of at most `chunk` elements; `fill` gets the index of its chunk's first element.
#[cfg(not(feature = "parallel"))]
pub(crate) fn fill_chunks<T>(output: &mut [T], chunk: usize, fill: impl Fn(usize, &mut [T])) {
    output.chunks_mut(chunk).enumerate().for_each(|(index, part)| fill(index * chunk, part));
}

/// Makes a value of each chunk of at most `chunk` elements, in order.
#[cfg(feature = "parallel")]
pub(crate) fn map_chunks<T: Sync, R: Send>(
    input: &[T],
    chunk: usize,
    map: impl Fn(usize, &[T]) -> R + Sync,
) -> Vec<R> {
    map_parts(input, chunk, &map)
}

#[cfg(feature = "parallel")]
fn map_parts<T: Sync, R: Send>(input: &[T], chunk: usize, map: &(dyn Fn(usize, &[T]) -> R + Sync)) -> Vec<R> {
    let parts = input.chunks(chunk);
    if parts.len() <= 1 {
        return parts.map(|part| map(0, part)).collect();
    }
    let mut values: Vec<Option<R>> = std::iter::repeat_with(|| None).take(parts.len()).collect();
    let mut work: Vec<Work<'_>> = Vec::with_capacity(values.len());
    for ((index, part), value) in parts.enumerate().zip(&mut values) {
        work.push(Box::new(move || *value = Some(map(index * chunk, part))));
    }
    run(work);
    values.into_iter().flatten().collect()
}

/// Makes a value of each chunk of at most `chunk` elements, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map_chunks<T, R>(input: &[T], chunk: usize, map: impl Fn(usize, &[T]) -> R) -> Vec<R> {
    input.chunks(chunk).enumerate().map(|(index, part)| map(index * chunk, part)).collect()
}

/// Runs something in the caller's thread pool while the caller goes on.
#[cfg(feature = "parallel")]
pub(crate) fn spawn(work: impl FnOnce() + Send + 'static) {
    rayon::spawn(work);
}

/// Runs something at once.
#[cfg(not(feature = "parallel"))]
pub(crate) fn spawn(work: impl FnOnce()) {
    work();
}

/// Appends a value made of each element, in order.
#[cfg(feature = "parallel")]
pub(crate) fn extend<S: Sync, T: Send>(
    output: &mut Vec<T>,
    input: &[S],
    make: impl Fn(usize, &S) -> T + Send + Sync,
) {
    use rayon::prelude::*;
    /// Some tens of microseconds of work; fewer are not worth waking a thread.
    const LEAST: usize = 1 << 12;
    if input.len() <= LEAST {
        output.extend(input.iter().enumerate().map(|(index, element)| make(index, element)));
    } else {
        let elements = input.par_iter().enumerate().with_min_len(LEAST);
        output.par_extend(elements.map(|(index, element)| make(index, element)));
    }
}

/// Appends a value made of each element, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn extend<S, T>(output: &mut Vec<T>, input: &[S], make: impl Fn(usize, &S) -> T) {
    output.extend(input.iter().enumerate().map(|(index, element)| make(index, element)));
}
