//! The order of rows and levels does not change a byte, and a file without all of them is none.

use super::made::{CONTAINERS, KINDS, Kind, Level, Made};
use crate::io::support::Folder;
use texbake::CodesRef;
use texbake::stream::MapOut;

/// Rows `first..end` of a level.
fn rows<'a>(kind: &Kind, level: &'a Level, first: usize, end: usize) -> CodesRef<'a> {
    let row = level.width * kind.channels;
    level.codes.as_ref().slice(first * row..end * row)
}

#[test]
fn any_order_gives_the_same_bytes() {
    let folder = Folder::new();
    for kind in KINDS {
        for container in CONTAINERS {
            let size = (37, 22);
            let whole = Made::new(&folder, kind, size, true, container);
            let path = folder.path(&format!("again.{container}"));
            for (piece, late) in [(1, false), (3, true), (5, false), (7, true)] {
                let MapOut { rows: mut sink, levels: smaller } = kind.create(&path, size, true).unwrap();
                assert!(sink.takes_first_row_last());
                let mut smaller = smaller.unwrap();
                // The smaller levels come from another thread, and row 0 of each after its others, where it may.
                let levels = &whole.levels;
                let starts_late = |level: &Level| late && level.height > 1;
                let pieces = |level: &Level| {
                    let start = usize::from(starts_late(level));
                    let late = starts_late(level).then_some((0, 1));
                    let height = level.height;
                    (start..height).step_by(piece).map(move |row| (row, (row + piece).min(height))).chain(late)
                };
                std::thread::scope(|scope| {
                    scope.spawn(|| {
                        for (at, level) in levels.iter().enumerate().skip(1) {
                            for (first, end) in pieces(level) {
                                smaller.write(at, first, rows(&kind, level, first, end)).unwrap();
                            }
                        }
                    });
                    for (first, end) in pieces(&levels[0]) {
                        sink.write(first, rows(&kind, &levels[0], first, end)).unwrap();
                    }
                });
                sink.finish().unwrap();
                assert!(std::fs::read(&path).unwrap() == whole.bytes(), "{} in {piece}, {late}", whole.path.display());
            }
        }
    }
}

#[test]
fn a_file_without_all_its_rows_does_not_appear() {
    let folder = Folder::new();
    for container in CONTAINERS {
        let (kind, path) = (KINDS[2], folder.path(&format!("n.{container}")));
        let levels = kind.levels((4, 4), true);
        // Levels that nobody wrote, and a level of which a row is missing.
        let MapOut { rows: mut sink, .. } = kind.create(&path, (4, 4), true).unwrap();
        sink.write(0, levels[0].codes.as_ref()).unwrap();
        let error = sink.complete().unwrap_err().to_string();
        assert_eq!(error, "mips is without 3 rows of the smaller levels: it must be complete");
        drop(sink);
        let MapOut { rows: mut sink, levels: smaller } = kind.create(&path, (4, 4), true).unwrap();
        let mut smaller = smaller.unwrap();
        sink.write(0, levels[0].codes.as_ref()).unwrap();
        smaller.write(1, 0, rows(&kind, &levels[1], 0, 1)).unwrap();
        smaller.write(2, 0, levels[2].codes.as_ref()).unwrap();
        // Rows that do not come next.
        for (level, first, codes) in [(1, 0, 6), (1, 1, 7), (2, 0, 3), (1, 1, 12)] {
            let error = smaller.write(level, first, CodesRef::U8(&vec![0; codes])).unwrap_err().to_string();
            assert!(error.starts_with("rows is "), "{error}");
        }
        for level in [0, 3] {
            let error = smaller.write(level, 0, CodesRef::U8(&[0; 3])).unwrap_err().to_string();
            assert_eq!(error, format!("level is {level}: it must be from 1 to 2"));
        }
        let error = sink.finish().unwrap_err().to_string();
        assert_eq!(error, "mips is without 1 rows of the smaller levels: it must be complete");
    }
    assert_eq!(folder.names(), [""; 0]);
}
