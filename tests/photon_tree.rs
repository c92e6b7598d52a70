//! The photon tree against brute force.

use glam::Vec3A;
use lightscope::engine::math::Rgb;
use lightscope::engine::path::ClassId;
use lightscope::engine::photon::record::{FullPhoton, PackedPhoton};
use lightscope::engine::photon::{Disc, KdTree, Nearest, Photon, Record, SplitRule};
use lightscope::engine::sampling::warp::sample_sphere;
use lightscope::engine::sampling::{IndependentSampler, Sampler, Stream};
use proptest::prelude::*;

fn sampler(item: u64) -> IndependentSampler {
    IndependentSampler::new(5, Stream::Test, (item, 0))
}

fn photon(p: Vec3A, wi: Vec3A, events: u32) -> Photon {
    let (power, class) = (Rgb::WHITE, ClassId::EMPTY);
    Photon {
        p,
        power,
        wi,
        class,
        events,
    }
}

fn tree<T: Record>(points: &[Vec3A], rule: SplitRule) -> KdTree<T> {
    let pack = |p: &Vec3A| T::pack(&photon(*p, Vec3A::Z, 1), Vec3A::Z, 1.0, 0.5);
    KdTree::build(points.iter().map(pack).collect(), rule)
}

/// The distances a search found, ascending.
fn found(nearest: &Nearest) -> Vec<f32> {
    let mut d2: Vec<f32> = nearest.found().map(|(d2, _)| d2).collect();
    d2.sort_by(f32::total_cmp);
    d2
}

/// Exact agreement of the n least squared distances below `r2`, for a plain search.
fn check(points: &[Vec3A], queries: &[Vec3A], counts: &[usize], r2: f32) {
    for rule in [SplitRule::Widest, SplitRule::Cyclic] {
        let tree: KdTree<FullPhoton> = tree(points, rule);
        assert_balanced(&tree);
        for &n in counts {
            let mut nearest = Nearest::new(n);
            for &q in queries {
                nearest.begin(r2);
                tree.locate_photons(q, &mut nearest, |_, _, d2| Some(d2));
                let mut all: Vec<f32> = points.iter().map(|p| (*p - q).length_squared()).collect();
                all.retain(|d2| *d2 < r2);
                all.sort_by(f32::total_cmp);
                all.truncate(n);
                assert_eq!(found(&nearest), all, "{n} of {} at {q}", points.len());
                let indices: std::collections::HashSet<usize> =
                    nearest.found().map(|(_, i)| i).collect();
                assert_eq!(indices.len(), all.len(), "a photon was found twice");
                // The radius shrinks only once the heap is full.
                let radius = if all.len() == n { all[n - 1] } else { r2 };
                assert_eq!(nearest.r2(), radius.min(r2));
            }
        }
    }
}

/// Children of photon p stand at 2p and 2p + 1, on their sides of the split.
fn assert_balanced<T: Record>(tree: &KdTree<T>) {
    let nodes = tree.nodes();
    for (index, node) in nodes.iter().enumerate().skip(1) {
        // Every ancestor, not the parent alone.
        let mut child = index + 1;
        while child > 1 {
            let parent = &nodes[child / 2 - 1];
            let (own, split) = (
                node.position()[parent.axis()],
                parent.position()[parent.axis()],
            );
            assert!(if child % 2 == 0 {
                own <= split
            } else {
                own >= split
            });
            child /= 2;
        }
    }
}

fn cloud(count: usize, item: u64) -> Vec<Vec3A> {
    let mut s = sampler(item);
    let mut point = || Vec3A::new(s.next_1d(), s.next_1d(), s.next_1d());
    (0..count).map(|_| point()).collect()
}

#[test]
fn no_photon_one_and_two() {
    for count in 0..=8 {
        let points = cloud(count, 1);
        check(&points, &cloud(20, 2), &[1, 2, 3, 50], f32::INFINITY);
        check(&points, &cloud(20, 3), &[1, 2, 3, 50], 0.2);
    }
}

#[test]
fn random_collinear_and_clustered_photons() {
    let even = cloud(3000, 4);
    let line: Vec<Vec3A> = even.iter().map(|p| Vec3A::new(0.3, p.y, 0.7)).collect();
    let plane: Vec<Vec3A> = even.iter().map(|p| Vec3A::new(p.x, 0.0, p.z)).collect();
    let cluster: Vec<Vec3A> = even
        .iter()
        .enumerate()
        .map(|(i, p)| (*p - 0.5) * 10f32.powi(-((i % 7) as i32)) + 0.5)
        .collect();
    let grid: Vec<Vec3A> = even.iter().map(|p| (*p * 8.0).floor()).collect();
    let far: Vec<Vec3A> = even.iter().map(|p| *p * 1e-3 + 1e4).collect();
    for points in [&even, &line, &plane, &cluster, &grid, &far] {
        let mut queries = cloud(40, 5);
        queries.extend_from_slice(&points[..20]);
        queries.push(Vec3A::splat(-3.0));
        check(points, &queries, &[1, 7, 50], f32::INFINITY);
        check(points, &queries, &[50], 0.01);
        check(points, &queries[..2], &[3000, 5000], f32::INFINITY);
    }
}

#[test]
fn a_million_photons_in_one_place() {
    let points = vec![Vec3A::new(1.0, 2.0, 3.0); 1_000_000];
    let tree: KdTree<PackedPhoton> = tree(&points, SplitRule::Widest);
    assert_eq!(tree.memory_bytes(), 20_000_000);
    let mut nearest = Nearest::new(50);
    // At a distance of 0 the search ends once it has fifty.
    for q in [points[0], Vec3A::ZERO] {
        for _ in 0..1000 {
            nearest.begin(f32::INFINITY);
            tree.locate_photons(q, &mut nearest, |_, _, d2| Some(d2));
            assert_eq!(found(&nearest), vec![(points[0] - q).length_squared(); 50]);
        }
    }
}

#[test]
fn the_filters_act_inside_the_search() {
    let mut s = sampler(6);
    let photons: Vec<Photon> = cloud(4000, 7)
        .into_iter()
        .map(|p| {
            let events = (s.next_1d() * 3.0) as u32;
            photon(p, sample_sphere(s.next_2d()), events)
        })
        .collect();
    let pack = |p: &Photon| FullPhoton::pack(p, Vec3A::Z, 1.0, 0.5);
    let tree = KdTree::build(photons.iter().map(pack).collect(), SplitRule::Widest);
    let mut nearest = Nearest::new(40);
    for (i, p) in cloud(100, 8).into_iter().enumerate() {
        let n = sample_sphere(s.next_2d());
        for without_direct in [false, true] {
            let disc = Disc {
                p,
                n,
                max_radius: 0.2 + 0.01 * i as f32,
                without_direct,
            };
            let r2 = disc.max_radius * disc.max_radius;
            nearest.begin(r2);
            tree.locate_photons(p, &mut nearest, |t, d, d2| disc.metric(t, d, d2));
            let metric = |t: &FullPhoton| {
                let d = Vec3A::from_array(*t.position()) - p;
                disc.metric(t, d, d.length_squared())
            };
            let mut all: Vec<f32> = tree.nodes().iter().filter_map(metric).collect();
            all.retain(|d2| *d2 < r2);
            all.sort_by(f32::total_cmp);
            all.truncate(40);
            assert_eq!(found(&nearest), all);
            // By hand: side, empty prefix, and a disc that is flat along the normal.
            for (_, index) in nearest.found() {
                let node = &tree.nodes()[index];
                let height = (Vec3A::from_array(*node.position()) - p).dot(n).abs();
                assert!(node.direction().dot(n) > 0.0 && height <= 0.25 * disc.max_radius + 1e-6);
                assert!(!without_direct || node.events() > 0);
            }
        }
    }
}

#[test]
fn any_number_of_threads_builds_the_same_tree() {
    let points = cloud(100_000, 9);
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| tree::<PackedPhoton>(&points, SplitRule::Widest))
    };
    let one = build(1);
    assert!(one.nodes() == build(2).nodes() && one.nodes() == build(8).nodes());
}

#[test]
fn splitting_planes_halve_their_boxes() {
    let tree: KdTree<PackedPhoton> = tree(&cloud(1000, 10), SplitRule::Widest);
    let planes = tree.planes([0.0; 3], [1.0; 3], 3);
    assert_eq!(planes.len(), 1 + 2 + 4 + 8);
    for plane in planes {
        assert!(plane.lo[plane.axis] <= plane.at && plane.at <= plane.hi[plane.axis]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Coordinates from a few values give many ties.
    #[test]
    fn exact_for_any_points(
        coordinates in prop::collection::vec((0u8..9, 0u8..9, -1e3f32..1e3), 0..120),
        query in (-10f32..20.0, -10f32..20.0, -1e3f32..1e3),
        n in 1usize..60,
        r2 in prop_oneof![Just(f32::INFINITY), 0f32..1e4],
    ) {
        let points: Vec<Vec3A> = coordinates
            .iter()
            .map(|(x, y, z)| Vec3A::new(f32::from(*x), f32::from(*y), *z))
            .collect();
        let q = Vec3A::new(query.0, query.1, query.2);
        let mut queries = vec![q];
        queries.extend(points.first());
        check(&points, &queries, &[n], r2);
    }
}
