//! scratch
use std::time::Instant;
use texbake::*;
fn main() {
    let mut s = 1u64;
    let mut rnd = move || {
        s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (s >> 32) as u32
    };
    let n: usize = std::env::args().nth(1).map(|a| a.parse().unwrap()).unwrap_or(300);
    let m8: HeightMap = Grid::from_fn(n + 1, 77, |_, _| rnd() as u8).unwrap().into();
    let m16: HeightMap = Grid::from_fn(n, 91, |_, _| rnd() as u16).unwrap().into();
    let mf: HeightMap =
        Grid::from_fn(n + 2, 63, |_, _| f32::from_bits(rnd() & 0xff7fffff)).unwrap().try_into().unwrap();
    let mg: HeightMap = Grid::from_fn(n + 2, 63, |_, _| (rnd() & 0xffff) as f32 / 65536.0).unwrap().try_into().unwrap();
    let mut formats = vec![];
    for encoding in [Encoding::Unorm, Encoding::Snorm, Encoding::Biased] {
        for depth in [Depth::Bits8, Depth::Bits16] {
            for channels in [Channels::Xyz, Channels::Xy] {
                formats.push(NormalFormat { encoding, depth, channels, convention: Convention::Gl });
            }
        }
    }
    for depth in [Depth::Float16, Depth::Float32] {
        for channels in [Channels::Xyz, Channels::Xy] {
            formats.push(NormalFormat { encoding: Encoding::Float, depth, channels, convention: Convention::Dx });
        }
    }
    let reference = Baker::reference();
    for name in std::env::args().skip(2).collect::<Vec<_>>() {
        let t = Instant::now();
        let gpu = match Baker::gpu(Some(&name)) {
            Ok(g) => g,
            Err(e) => {
                println!("{name}: {e}");
                continue;
            }
        };
        println!("{name}: {} opened in {:?}", gpu.name(), t.elapsed());
        let t = Instant::now();
        let mut bad = 0;
        let mut all = 0;
        for (mi, map) in [&m8, &m16, &mf, &mg].into_iter().enumerate() {
            for format in &formats {
                for (filter, edge, scale) in [
                    (Filter::Central, Edge::Wrap, "24"),
                    (Filter::Scharr, Edge::Mirror, "-16777213/9699691"),
                    (Filter::Sobel, Edge::Clamp, "0.35"),
                ] {
                    for precision in [Precision::Exact, Precision::Fast] {
                        let o = NormalOptions {
                            scale: Scale::Texels(scale.parse().unwrap()),
                            filter,
                            edges: Edges::both(edge),
                            format: *format,
                            precision,
                        };
                        let a = gpu.normal(map, &o).unwrap();
                        let b = reference.normal(map, &o).unwrap();
                        all += 1;
                        if precision == Precision::Exact && a != b {
                            bad += 1;
                            let (x, y) = (a.codes().bytes(), b.codes().bytes());
                            let d = x.iter().zip(y).filter(|(p, q)| p != q).count();
                            println!("map {mi} {o:?}: {d}/{} bytes differ", x.len());
                        }
                        if precision == Precision::Fast && format.encoding != Encoding::Float {
                            let worst = match (a.codes(), b.codes()) {
                                (CodesRef::U8(x), CodesRef::U8(y)) => x
                                    .iter()
                                    .zip(y)
                                    .map(|(p, q)| (*p as i8).wrapping_sub(*q as i8).unsigned_abs() as u32)
                                    .max()
                                    .unwrap(),
                                (CodesRef::U16(x), CodesRef::U16(y)) => x
                                    .iter()
                                    .zip(y)
                                    .map(|(p, q)| (*p as i16).wrapping_sub(*q as i16).unsigned_abs() as u32)
                                    .max()
                                    .unwrap(),
                                _ => 0,
                            };
                            if worst > 1 {
                                println!("fast map {mi} {o:?}: worst {worst}");
                            }
                        }
                    }
                }
            }
        }
        println!("{name}: {bad} of {all} differ, {:?}", t.elapsed());
    }
}
