//! The same for programs that call the library.

use super::support::textures;
use std::path::PathBuf;
use std::sync::Arc;
use texbake::batch::{Event, FileResult, FreshPlan, Freshness, Job, NormalInput, Reason};
use texbake::io::{NormalReadOptions, ReadOptions, WriteOptions};
use texbake::stream::Monitor;
use texbake::{BakeOptions, Baker, Channels, Edge, Edges, Filter, Maps, ParallaxFormat};

fn reasons(jobs: &[Job], out: &std::path::Path) -> Vec<Freshness> {
    FreshPlan::new(jobs, out, false, &Monitor::default()).files().collect()
}

#[test]
fn a_given_normal_map_is_an_input() {
    let folder = textures();
    folder.run(&["normal", "tex/a_height.png", "-o", "given.png", "-q"]).ends(0);
    let parallax: PathBuf = folder.path("out/p.tif");
    let job = |read: NormalReadOptions| Job {
        input: folder.path("tex/a_height.png"),
        outputs: Maps { normal: None, parallax: Some(parallax.clone()), roughness: None },
        normals: Some(NormalInput { path: folder.path("given.png"), read }),
        neighbours: None,
        read: ReadOptions::default(),
        options: BakeOptions { normal: None, parallax: Some(ParallaxFormat::default()), ..BakeOptions::default() },
        write: WriteOptions::default(),
        baker: Arc::new(Baker::reference()),
    };
    let (out, usual) = (folder.path("out"), [job(NormalReadOptions::default())]);
    let monitor = Monitor::default();
    let plan = FreshPlan::new(&usual, &out, false, &monitor);
    assert_eq!(plan.files().collect::<Vec<_>>(), [Freshness::Stale(Reason::New)]);
    let outcomes = plan.run(1, &monitor, &|_| ());
    assert_eq!(FileResult::of(&outcomes[0]), FileResult::Baked, "{:?}", outcomes[0].result);
    assert_eq!((plan.warnings(), reasons(&usual, &out)), (Vec::new(), vec![Freshness::Fresh]));

    folder.run(&["normal", "tex/a_height.png", "-o", "given.png", "-q", "--scale", "9"]).ends(0);
    assert_eq!(reasons(&usual, &out), [Freshness::Stale(Reason::Input(folder.path("given.png")))]);
    FreshPlan::new(&usual, &out, false, &monitor).run(1, &monitor, &|_| ());
    assert_eq!(reasons(&usual, &out), [Freshness::Fresh]);
    // How it is read counts.
    let xy = [job(NormalReadOptions { channels: Some(Channels::Xy), ..Default::default() })];
    let text: Vec<String> = reasons(&xy, &out).iter().map(ToString::to_string).collect();
    assert_eq!(text, ["normals found found gl -> found xy gl"]);
    // Slopes of the heights are not looked at.
    let options = BakeOptions { filter: Filter::Sobel, edges: Edges::both(Edge::Clamp), ..usual[0].options };
    assert_eq!(reasons(&[Job { options, ..usual[0].clone() }], &out), [Freshness::Fresh]);
    let own = [Job { normals: None, ..usual[0].clone() }];
    let text: Vec<String> = reasons(&own, &out).iter().map(ToString::to_string).collect();
    assert_eq!(text, ["normals found found gl -> none"]);
}

#[test]
fn maps_of_two_runs_are_no_maps_of_one() {
    let folder = textures();
    let both = BakeOptions { parallax: Some(ParallaxFormat::default()), ..BakeOptions::default() };
    let output = |name: &str| folder.path(&format!("out/{name}.tif"));
    let job = |normal: &str, parallax: &str| Job {
        input: folder.path("tex/a_height.png"),
        outputs: Maps { normal: Some(output(normal)), parallax: Some(output(parallax)), roughness: None },
        normals: None,
        neighbours: None,
        read: ReadOptions::default(),
        options: both,
        write: WriteOptions::default(),
        baker: Arc::new(Baker::reference()),
    };
    let (out, monitor) = (folder.path("out"), Monitor::default());
    for jobs in [[job("n", "other_p")], [job("other_n", "p")]] {
        FreshPlan::new(&jobs, &out, false, &monitor).run(1, &monitor, &|_| ());
        assert_eq!(reasons(&jobs, &out), [Freshness::Fresh]);
    }
    let found = reasons(&[job("n", "p")], &out);
    assert_eq!(found, [Freshness::Stale(Reason::Apart(output("p"), output("n")))]);
    let told = format!("{} was baked apart from {}", output("p").display(), output("n").display());
    assert_eq!(found[0].to_string(), told);
}

#[test]
fn events_and_outcomes_have_the_places_of_all_jobs() {
    let folder = textures();
    let job = |name: &str| Job {
        input: folder.path(&format!("tex/{name}_height.png")),
        outputs: Maps { normal: Some(folder.path(&format!("out/{name}.png"))), parallax: None, roughness: None },
        normals: None,
        neighbours: None,
        read: ReadOptions::default(),
        options: BakeOptions::default(),
        write: WriteOptions::default(),
        baker: Arc::new(Baker::reference()),
    };
    let (out, monitor) = (folder.path("out"), Monitor::default());
    let first = [job("a")];
    FreshPlan::new(&first, &out, false, &monitor).run(1, &monitor, &|_| ());
    let jobs = [job("gone"), job("a"), job("b"), job("sub/c")];
    let ended = std::sync::Mutex::new(Vec::new());
    let outcomes = FreshPlan::new(&jobs, &out, false, &monitor).run(1, &monitor, &|event| {
        if let Event::Ended { job, outcome } = event {
            ended.lock().unwrap().push((job, FileResult::of(outcome)));
        }
    });
    use FileResult::{Baked, Failed, Fresh};
    assert_eq!(ended.into_inner().unwrap(), [(1, Fresh), (0, Failed), (2, Baked), (3, Baked)]);
    let results: Vec<FileResult> = outcomes.iter().map(FileResult::of).collect();
    assert_eq!(results, [Failed, Fresh, Baked, Baked]);
    assert_eq!(outcomes[1].result.as_ref().unwrap().size.to_string(), "9 x 8");
}

/// A plan that was cancelled knows nothing of files that it did not read to the end; small ones it reads.
#[test]
fn a_cancelled_plan_says_so() {
    let folder = textures();
    const SIDE: usize = 1100;
    folder.file("tex/large_height.raw", (0..SIDE * SIDE).map(|index| (index % 251) as u8).collect::<Vec<_>>());
    let job = |input: &str, raw: Option<&str>| Job {
        input: folder.path(input),
        outputs: Maps { normal: Some(folder.path("out").join(input).with_extension("png")), ..Maps::default() },
        normals: None,
        neighbours: None,
        read: ReadOptions { raw: raw.map(|raw| raw.parse().unwrap()), ..ReadOptions::default() },
        options: BakeOptions::default(),
        write: WriteOptions::default(),
        baker: Arc::new(Baker::cpu()),
    };
    let jobs = [job("tex/a_height.png", None), job("tex/large_height.raw", Some("1100x1100:u8"))];
    let (out, monitor) = (folder.path("out"), Monitor::default());
    FreshPlan::new(&jobs, &out, false, &monitor).run(1, &monitor, &|_| ());
    monitor.cancel();
    let plan = FreshPlan::new(&jobs, &out, false, &monitor);
    let found: Vec<Freshness> = plan.files().collect();
    assert_eq!(found, [Freshness::Fresh, Freshness::Stale(Reason::Interrupted)]);
    let outcomes = plan.run(1, &monitor, &|_| ());
    let results: Vec<FileResult> = outcomes.iter().map(FileResult::of).collect();
    assert_eq!(results, [FileResult::Fresh, FileResult::NotBegun]);
    assert_eq!(reasons(&jobs, &out), [Freshness::Fresh, Freshness::Fresh]);
}
