use cohelm::registry::*; use cohelm_learn::*; use std::num::NonZeroUsize; use std::ops::ControlFlow;
fn main(){
 let mut plants=Plants::default(); plants.register(cohelm_drone::entry());
 let task=Task::new("drone");
 for seed in 0..2{
 let job=Job{plants:&plants,task:&task,seed,threads:NonZeroUsize::new(2).unwrap(),checkpoints:None,name:"drone",variant:None};
 let t=std::time::Instant::now();
 let r=train_values(&job,&ValueOptions::default(),None,&mut |_|ControlFlow::Continue(())).unwrap();
 println!("{seed} {:?} {:?}",r.validation,t.elapsed());
 std::fs::write(format!("/tmp/drone{seed}.st"),r.model.bytes()).unwrap();
 }
}
