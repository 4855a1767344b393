//! Memory that is counted, with a ceiling.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The system's allocator, which ends the process where more than the ceiling would be held.
struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static CEILING: AtomicUsize = AtomicUsize::new(usize::MAX);

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn hold(bytes: usize) {
    let held = HELD.fetch_add(bytes, Relaxed) + bytes;
    let ceiling = CEILING.load(Relaxed);
    if held > ceiling {
        CEILING.store(usize::MAX, Relaxed);
        panic_without_memory(bytes, held - ceiling);
    }
}

/// A panic here would allocate; an abort is what the fuzzer catches too.
fn panic_without_memory(bytes: usize, over: usize) -> ! {
    eprintln!("an allocation of {bytes} bytes takes the reader {over} bytes above its bound");
    eprintln!("{}", std::backtrace::Backtrace::force_capture());
    std::process::abort()
}

// Every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        hold(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        hold(layout.size());
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Relaxed);
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        // The old and the new memory may be there at once.
        hold(new_size);
        HELD.fetch_sub(layout.size(), Relaxed);
        unsafe { System.realloc(memory, layout, new_size) }
    }
}

/// Does something that may hold at most `bytes` more than is held now, by all threads together.
pub fn bounded<T>(bytes: usize, job: impl FnOnce() -> T) -> T {
    CEILING.store(HELD.load(Relaxed) + bytes, Relaxed);
    let result = job();
    CEILING.store(usize::MAX, Relaxed);
    result
}
