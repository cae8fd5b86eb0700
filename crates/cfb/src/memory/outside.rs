//! try
use super::tests::*;
use super::*;
use cube3_host::*;

#[test]
fn table() {
    let sdram = MemoryModel::of(MemoryType::Sdram);
    let hbm = MemoryModel::of(MemoryType::Hbm);
    for hash in [BankHash::Plain, BankHash::Xor, BankHash::DigitSum] {
        for order in [None, Some(BurstOrder::Interleaved)] {
            println!("{hash:?} {order:?}");
            for refresh in [false, true] {
                let t = |m: &MemoryModel| {
                    let t = Timing {
                        hash,
                        burst_order: order.filter(|_| m.burst_order.is_some()),
                        ..Timing::new(m, m.clock_hz.unwrap())
                    };
                    if refresh { t } else { Timing { refresh_interval: None, ..t } }
                };
                let s = t(sdram);
                let h = t(hbm);
                println!("  refresh {refresh}");
                println!("   random sdram {}", stream(&s, random(100_000)).0);
                println!("   random hbm {}", stream(&h, random(100_000)).0);
                println!("   seq {}", stream(&s, 0..100_000).0);
                for n in [256_u64, 512] {
                    println!(
                        "   y+nz {n} words n^2: {}  hbm {}",
                        stream(&s, (0..n * n).map(|i| i / n + n * (i % n))).0,
                        stream(&h, (0..n * n).map(|i| i / n + n * (i % n))).0
                    );
                }
            }
        }
    }
}
