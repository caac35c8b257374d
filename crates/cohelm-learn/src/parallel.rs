//! The same results for any number of threads: work is cut by index and put together by index.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Calls `work` for 0..count on up to `threads` threads; results come in the order of the indices.
pub(crate) fn map<R: Send>(count: usize, threads: NonZeroUsize, work: impl Fn(usize) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let some = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return done;
            }
            done.push((index, work(index)));
        }
    };
    let mut done = thread::scope(|scope| {
        let others: Vec<_> = (1..threads.get().min(count)).map(|_| scope.spawn(some)).collect();
        let mut done = some();
        for other in others {
            done.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        done
    });
    done.sort_unstable_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}

/// Calls `work` for every item on up to `threads` threads; results come in the order of the items.
pub(crate) fn map_mut<T: Send, R: Send>(
    items: &mut [T],
    threads: NonZeroUsize,
    work: impl Fn(&mut T) -> R + Sync,
) -> Vec<R> {
    let share = items.len().div_ceil(threads.get()).max(1);
    let some = |items: &mut [T]| items.iter_mut().map(&work).collect::<Vec<R>>();
    thread::scope(|scope| {
        let mut shares = items.chunks_mut(share);
        let own = shares.next();
        let others: Vec<_> = shares.map(|share| scope.spawn(|| some(share))).collect();
        let mut done = own.map(some).unwrap_or_default();
        for other in others {
            done.extend(other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        done
    })
}

/// Does two things at once if there are at least two threads, otherwise one after the other. The first gets all
/// threads but one.
pub(crate) fn both<A: Send, B>(
    threads: NonZeroUsize,
    first: impl FnOnce(NonZeroUsize) -> A + Send,
    second: impl FnOnce() -> B,
) -> (A, B) {
    let Some(others) = NonZeroUsize::new(threads.get() - 1) else {
        return (first(threads), second());
    };
    thread::scope(|scope| {
        let first = scope.spawn(move || first(others));
        let second = second();
        (first.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), second)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_for_any_number_of_threads() {
        for threads in [1, 2, 3, 8] {
            let threads = NonZeroUsize::new(threads).unwrap();
            assert_eq!(map(5, threads, |i| i * i), [0, 1, 4, 9, 16]);
            let mut items = [1, 2, 3, 4, 5];
            let doubled = map_mut(&mut items, threads, |item| {
                *item += 1;
                *item * 2
            });
            assert_eq!((items, doubled), ([2, 3, 4, 5, 6], vec![4, 6, 8, 10, 12]));
            assert_eq!(both(threads, |others| others.get().max(1), || 7).1, 7);
            assert!(map(0, threads, |i| i).is_empty());
        }
    }
}
