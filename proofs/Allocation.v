(** * Every rotor stays within its range

    Sections 4 and 8 of docs/extended-law.md, in exact arithmetic.
    controller-core/src/extended/thrust_range.rs holds [floor], [ceiling],
    [thrust], [yaw] and [floor_share]; controller-core/src/extended/budget.rs
    holds the rows.

    A rotor's command is f = b (T + beta . tau) with b > 0. Tilt comes first,
    then thrust, then yaw. *)

From Coq Require Import Reals Lra List.
From SaturatedHybrid Require Import Space.
Import ListNotations.
Open Scope R_scope.

Lemma both_sides : forall a c, Rabs a <= c -> - c <= a <= c.
Proof. intros a c H. unfold Rabs in H. destruct (Rcase_abs a); lra. Qed.

(** A rotor: b (thrust per collective thrust), beta = b_tau / b about the
    tilt's axes, a vector with z = 0, and about z, and its range, N. *)
Record rotor := { b : R; beta : space; beta_z : R; least : R; greatest : R }.

(** The command for a rotor, N, of a thrust and a torque. *)
Definition command (r : rotor) (T : R) (tau : space) (tau_z : R) : R :=
  b r * (T + (dot (beta r) tau + beta_z r * tau_z)).

Section Law.

Variables (s margin T_max yaw_max : R) (rotors : list rotor) (tau : space).

Definition needs (r : rotor) : R := s * least r / b r + (margin - dot (beta r) tau).
Definition gives (r : rotor) : R := s * greatest r / b r - (dot (beta r) tau + margin).

(** N(tau) and C(tau) of the tilt's torque; C beside a yaw torque that brakes. All
    begin as the code does. *)
Definition gives_beside (braking : R) (r : rotor) : R :=
  s * greatest r / b r - (dot (beta r) tau + beta_z r * braking + margin).
Definition floor : R := fold_right (fun r n => Rmax n (needs r)) margin rotors.
Definition ceiling : R := fold_right (fun r c => Rmin c (gives r)) T_max rotors.
Definition ceiling_beside (braking : R) : R := fold_right (fun r c => Rmin c (gives_beside braking r)) T_max rotors.

(** T for a wanted thrust. *)
Definition thrust (braking wanted : R) : R :=
  Rmin (Rmax floor (Rmin ceiling (ceiling_beside braking))) (Rmax floor wanted).

(** The ends of tau_z that a rotor leaves at the thrust T. *)
Definition yaw_low (T : R) (r : rotor) : R :=
  if Req_EM_T (beta_z r) 0 then - yaw_max
  else if Rlt_dec 0 (beta_z r) then (s * least r / b r + margin - (T + dot (beta r) tau)) / beta_z r
  else (s * greatest r / b r - margin - (T + dot (beta r) tau)) / beta_z r.
Definition yaw_high (T : R) (r : rotor) : R :=
  if Req_EM_T (beta_z r) 0 then yaw_max
  else if Rlt_dec 0 (beta_z r) then (s * greatest r / b r - margin - (T + dot (beta r) tau)) / beta_z r
  else (s * least r / b r + margin - (T + dot (beta r) tau)) / beta_z r.

(** The interval of tau_z, and tau_z for a wanted yaw torque. *)
Definition yaw_least (T : R) : R := Rmin (fold_right (fun r l => Rmax l (yaw_low T r)) (- yaw_max) rotors) 0.
Definition yaw_most (T : R) : R := Rmax (fold_right (fun r h => Rmin h (yaw_high T r)) yaw_max rotors) 0.
Definition yaw (T wanted : R) : R := Rmin (yaw_most T) (Rmax (yaw_least T) wanted).

(** Of the greatest and of the least of a list. *)
Lemma greatest_covers : forall (f : rotor -> R) start r, In r rotors ->
  f r <= fold_right (fun r n => Rmax n (f r)) start rotors.
Proof.
  intros f start. induction rotors as [|r' rest IH]; intros r H; [contradiction|]. cbn.
  destruct H as [<-|H]; [apply Rmax_r | eapply Rle_trans; [apply IH, H | apply Rmax_l]].
Qed.

Lemma greatest_below : forall (f : rotor -> R) start m, start <= m -> (forall r, In r rotors -> f r <= m) ->
  fold_right (fun r n => Rmax n (f r)) start rotors <= m.
Proof.
  intros f start m Hm. induction rotors as [|r' rest IH]; intros H; cbn; [exact Hm|].
  apply Rmax_lub; [apply IH; intros; apply H; now right | apply H; now left].
Qed.

Lemma greatest_from : forall (f : rotor -> R) start, start <= fold_right (fun r n => Rmax n (f r)) start rotors.
Proof. intros f start. induction rotors; cbn; [lra | eapply Rle_trans; [exact IHl | apply Rmax_l]]. Qed.

Lemma least_covers : forall (f : rotor -> R) start r, In r rotors ->
  fold_right (fun r n => Rmin n (f r)) start rotors <= f r.
Proof.
  intros f start. induction rotors as [|r' rest IH]; intros r H; [contradiction|]. cbn.
  destruct H as [<-|H]; [apply Rmin_r | eapply Rle_trans; [apply Rmin_l | apply IH, H]].
Qed.

Lemma least_above : forall (f : rotor -> R) start m, m <= start -> (forall r, In r rotors -> m <= f r) ->
  m <= fold_right (fun r n => Rmin n (f r)) start rotors.
Proof.
  intros f start m Hm. induction rotors as [|r' rest IH]; intros H; cbn; [exact Hm|].
  apply Rmin_glb; [apply IH; intros; apply H; now right | apply H; now left].
Qed.

Lemma least_from : forall (f : rotor -> R) start, fold_right (fun r n => Rmin n (f r)) start rotors <= start.
Proof. intros f start. induction rotors; cbn; [lra | eapply Rle_trans; [apply Rmin_l | exact IHl]]. Qed.

Hypothesis b_positive : forall r, In r rotors -> 0 < b r.

(** What the tilt's torque has to leave, pair by pair: no rotor needs more than
    any gives. Then N <= C. *)
Definition torque_fits : Prop :=
  (forall r, In r rotors -> needs r <= T_max) /\
  (forall r r', In r rotors -> In r' rotors -> needs r <= gives r').

Hypothesis fits : torque_fits.

(** Rotors share a thrust but cancel in a torque. *)
Definition total (f : rotor -> R) : R := fold_right (fun r n => f r + n) 0 rotors.
Hypothesis least_nonneg : forall r, In r rotors -> 0 <= s * least r.
Hypothesis thrust_is_shared : total b = 1.
Hypothesis torque_cancels : total (fun r => b r * dot (beta r) tau) = 0.

Lemma total_below : forall f g, (forall r, In r rotors -> f r <= g r) -> total f <= total g.
Proof.
  unfold total. clear. induction rotors as [|r rest IH]; intros f g H; cbn; [lra|].
  assert (f r <= g r) by (apply H; now left). specialize (IH f g (fun r' H' => H r' (or_intror H'))). lra.
Qed.

(** So some rotor needs the margin. *)
Lemma margin_below : forall most, (forall r, In r rotors -> needs r <= most) -> margin <= most.
Proof.
  intros most Hmost.
  assert (H : total (fun r => b r * margin - b r * dot (beta r) tau) <= total (fun r => b r * most)).
  { apply total_below. intros r Hr. pose proof (b_positive r Hr). pose proof (Hmost r Hr) as Hn.
    apply Rmult_le_compat_l with (r := b r) in Hn; [|lra]. unfold needs in Hn.
    replace (b r * (s * least r / b r + (margin - dot (beta r) tau)))
      with (s * least r + (b r * margin - b r * dot (beta r) tau)) in Hn by (field; lra).
    pose proof (least_nonneg r Hr). lra. }
  replace (total (fun r => b r * margin - b r * dot (beta r) tau))
    with (total b * margin - total (fun r => b r * dot (beta r) tau)) in H.
  - replace (total (fun r => b r * most)) with (total b * most) in H;
      [rewrite thrust_is_shared, torque_cancels in H; lra|].
    unfold total. clear. induction rotors; cbn; [|rewrite <- IHl]; ring.
  - unfold total. clear. induction rotors; cbn; [|rewrite <- IHl]; ring.
Qed.

Lemma floor_below : floor <= T_max /\ forall r, In r rotors -> floor <= gives r.
Proof.
  destruct fits as (Ht & Hp). split; [|intros r Hr]; (apply greatest_below; [apply margin_below|]).
  1, 2: exact Ht. all: intros r' Hr'; now apply Hp.
Qed.

Lemma thrust_between : forall braking wanted, floor <= thrust braking wanted <= T_max
  /\ forall r, In r rotors -> needs r <= thrust braking wanted <= gives r.
Proof.
  intros braking wanted. destruct floor_below as (Hlimit & Hgives). unfold thrust.
  assert (Hfloor : floor <= Rmin (Rmax floor (Rmin ceiling (ceiling_beside braking))) (Rmax floor wanted))
    by (apply Rmin_glb; apply Rmax_l).
  assert (Hmost : forall most, floor <= most -> ceiling <= most ->
    Rmin (Rmax floor (Rmin ceiling (ceiling_beside braking))) (Rmax floor wanted) <= most).
  { intros most H H'. eapply Rle_trans; [apply Rmin_l|]. apply Rmax_lub; [exact H|].
    eapply Rle_trans; [apply Rmin_l | exact H']. }
  split; [split; [exact Hfloor | apply Hmost; [exact Hlimit | apply least_from]]|].
  intros r Hr. split.
  - eapply Rle_trans; [|exact Hfloor]. now apply (greatest_covers needs).
  - apply Hmost; [now apply Hgives | now apply (least_covers gives T_max)].
Qed.

Lemma over_nonneg : forall a c, 0 <= a -> 0 < c -> 0 <= a / c.
Proof. intros a c Ha Hc. apply Rmult_le_pos; [exact Ha | left; now apply Rinv_0_lt_compat]. Qed.

Lemma over_below : forall a c t, 0 < c -> (a / c <= t <-> a <= c * t) /\ (t <= a / c <-> c * t <= a).
Proof.
  intros a c t Hc. assert (E : c * (a / c) = a) by (field; lra).
  repeat split; intros H; try (apply Rmult_le_reg_l with c; lra);
    apply Rmult_le_compat_l with (r := c) in H; lra.
Qed.

(** What the ends mean. *)
Lemma between_ends : forall T r t, beta_z r <> 0 -> (yaw_low T r <= t <= yaw_high T r <->
  s * least r / b r + margin <= T + (dot (beta r) tau + beta_z r * t) <= s * greatest r / b r - margin).
Proof.
  intros T r t Hne. unfold yaw_low, yaw_high. destruct (Req_EM_T (beta_z r) 0); [contradiction|].
  set (low := s * least r / b r) in *. set (high := s * greatest r / b r) in *. set (c := beta_z r) in *.
  destruct (Rlt_dec 0 c) as [Hz|Hz].
  - destruct (over_below (low + margin - (T + dot (beta r) tau)) c t Hz) as [H1 _].
    destruct (over_below (high - margin - (T + dot (beta r) tau)) c t Hz) as [_ H2]. rewrite H1, H2. lra.
  - assert (Hc : 0 < - c) by lra.
    replace ((high - margin - (T + dot (beta r) tau)) / c) with ((- (high - margin - (T + dot (beta r) tau))) / - c)
      by (field; lra).
    replace ((low + margin - (T + dot (beta r) tau)) / c) with ((- (low + margin - (T + dot (beta r) tau))) / - c)
      by (field; lra).
    destruct (over_below (- (high - margin - (T + dot (beta r) tau))) (- c) t Hc) as [H1 _].
    destruct (over_below (- (low + margin - (T + dot (beta r) tau))) (- c) t Hc) as [_ H2]. rewrite H1, H2. lra.
Qed.

Lemma zero_between : forall T r, 0 <= yaw_max -> needs r <= T <= gives r -> yaw_low T r <= 0 <= yaw_high T r.
Proof.
  intros T r Hy H. destruct (Req_dec (beta_z r) 0) as [E|E].
  - unfold yaw_low, yaw_high. destruct (Req_EM_T (beta_z r) 0); [lra | contradiction].
  - apply between_ends; [exact E|]. unfold needs, gives in H. lra.
Qed.

(** So it is in the interval: no end is moved to it, and yaw gets the nearest to
    what it wants. *)
Theorem zero_is_left : forall braking wanted, 0 <= yaw_max -> let T := thrust braking wanted in
  - yaw_max <= yaw_least T <= 0 /\ 0 <= yaw_most T <= yaw_max
  /\ (forall r, In r rotors -> yaw_low T r <= yaw_least T /\ yaw_most T <= yaw_high T r).
Proof.
  intros braking wanted Hy T.
  assert (Hz : forall r, In r rotors -> yaw_low T r <= 0 <= yaw_high T r)
    by (intros; now apply zero_between, thrust_between).
  pose proof (greatest_below (yaw_low T) (- yaw_max) 0 ltac:(lra) (fun r H => proj1 (Hz r H))) as Hl.
  pose proof (least_above (yaw_high T) yaw_max 0 Hy (fun r H => proj2 (Hz r H))) as Hm.
  pose proof (greatest_from (yaw_low T) (- yaw_max)). pose proof (least_from (yaw_high T) yaw_max).
  unfold yaw_least, yaw_most. rewrite Rmin_left, Rmax_left by lra. repeat split; try lra.
  - now apply greatest_covers.
  - now apply least_covers.
Qed.

(** Whatever thrust and whatever yaw torque are wanted, every rotor is within
    its range, by the margin; thrust and yaw are within their limits. *)
Theorem rotors_within_range : forall braking wanted wanted_yaw, 0 <= yaw_max ->
  let T := thrust braking wanted in let tau_z := yaw T wanted_yaw in
  (forall r, In r rotors ->
    s * least r + b r * margin <= command r T tau tau_z <= s * greatest r - b r * margin)
  /\ T <= T_max /\ Rabs tau_z <= yaw_max.
Proof.
  intros braking wanted wanted_yaw Hy T tau_z.
  destruct (zero_is_left braking wanted Hy) as (Hl & Hm & Hends). fold T in Hl, Hm, Hends.
  assert (Hbetween : yaw_least T <= tau_z <= yaw_most T).
  { unfold tau_z, yaw. split; [apply Rmin_glb; [lra | apply Rmax_l] | apply Rmin_l]. }
  split; [|split; [apply thrust_between | apply Rabs_le; lra]].
  intros r Hr. destruct (Hends r Hr). pose proof (b_positive r Hr) as Hb.
  pose proof (proj2 (thrust_between braking wanted) r Hr) as HT.
  fold T in HT.
  assert (H1 : s * least r / b r + margin <= T + (dot (beta r) tau + beta_z r * tau_z)
    <= s * greatest r / b r - margin).
  { destruct (Req_dec (beta_z r) 0) as [E|E]; [|apply between_ends; [exact E | lra]].
    rewrite E. unfold needs, gives in HT. lra. }
  unfold command. set (sum := T + _) in *.
  pose proof (proj1 (proj1 (over_below (s * least r) (b r) (sum - margin) Hb)) ltac:(lra)).
  pose proof (proj1 (proj2 (over_below (s * greatest r) (b r) (sum + margin) Hb)) ltac:(lra)). lra.
Qed.

(** What brakes is left for yaw, where the rotors' least thrusts leave it and the
    tilt's torque does not need more thrust. *)
Theorem braking_is_left : forall braking wanted, Rabs braking <= yaw_max -> floor <= ceiling_beside braking ->
  let T := thrust braking wanted in
  (forall r, In r rotors -> s * least r / b r + margin <= T + (dot (beta r) tau + beta_z r * braking)) ->
  yaw_least T <= braking <= yaw_most T.
Proof.
  intros braking wanted Hlimit Hfloor T Hleast. apply both_sides in Hlimit.
  assert (HT : T <= ceiling_beside braking).
  { unfold T, thrust. eapply Rle_trans; [apply Rmin_l|]. apply Rmax_lub; [exact Hfloor | apply Rmin_r]. }
  assert (Hends : forall r, In r rotors -> yaw_low T r <= braking <= yaw_high T r).
  { intros r Hr. destruct (Req_dec (beta_z r) 0) as [E|E].
    - unfold yaw_low, yaw_high. destruct (Req_EM_T (beta_z r) 0); [lra | contradiction].
    - apply between_ends; [exact E|]. split; [now apply Hleast|].
      pose proof (least_covers (gives_beside braking) T_max r Hr) as Hc. fold (ceiling_beside braking) in Hc.
      unfold gives_beside in Hc. lra. }
  unfold yaw_least, yaw_most. split.
  - eapply Rle_trans; [apply Rmin_l|]. apply (greatest_below (yaw_low T)); [lra | apply Hends].
  - eapply Rle_trans; [|apply Rmax_l]. apply (least_above (yaw_high T)); [lra | apply Hends].
Qed.

(** Thrust is at least the margin. *)
Theorem thrust_is_upwards : forall braking wanted, margin <= thrust braking wanted.
Proof.
  intros braking wanted. eapply Rle_trans; [apply (greatest_from needs) | apply thrust_between].
Qed.

(** The share of a further torque [more] with which the floor stays at [most]. *)
Definition raised (more : space) (r : rotor) : R := - dot (beta r) more.
Definition floor_share (more : space) (most : R) : R :=
  fold_right (fun r share =>
    if Rlt_dec most (needs r + raised more r) then Rmin share ((most - needs r) / raised more r) else share) 1 rotors.

Theorem floor_share_keeps : forall more most, (forall r, In r rotors -> needs r <= most) ->
  0 <= floor_share more most <= 1
  /\ forall sigma r, 0 <= sigma <= floor_share more most -> In r rotors ->
     needs r + sigma * raised more r <= most.
Proof.
  intros more most. unfold floor_share. clear. induction rotors as [|r rest IH]; intros H; cbn.
  - split; [lra | intros; contradiction].
  - assert (Hn : needs r <= most) by (apply H; now left).
    destruct IH as [[H0 H1] Hrest]; [intros; apply H; now right|].
    set (sigma_rest := fold_right _ 1 rest) in *.
    destruct (Rlt_dec most (needs r + raised more r)) as [Hbeyond|Hbelow].
    + assert (Hpos : 0 < raised more r) by lra. split.
      * split; [apply Rmin_glb; [exact H0 | apply over_nonneg; lra] | eapply Rle_trans; [apply Rmin_l | exact H1]].
      * intros sigma r' Hs [<-|Hr'].
        -- assert (Hsr : sigma <= (most - needs r) / raised more r)
             by (eapply Rle_trans; [apply Hs | apply Rmin_r]).
           apply Rmult_le_compat_r with (r := raised more r) in Hsr; [|lra].
           replace ((most - needs r) / raised more r * raised more r) with (most - needs r) in Hsr by (field; lra). lra.
        -- apply Hrest; [|exact Hr']. split; [lra | eapply Rle_trans; [apply Hs | apply Rmin_l]].
    + split; [lra|]. intros sigma r' Hs [<-|Hr']; [|now apply Hrest].
      destruct (Rle_dec 0 (raised more r)).
      * assert (sigma * raised more r <= 1 * raised more r) by (apply Rmult_le_compat_r; lra). lra.
      * assert (0 <= sigma * - raised more r) by (apply Rmult_le_pos; lra). lra.
Qed.

End Law.

(** ** The rows: section 4 *)

(** |w . tau| <= R(s), w of length one. *)
Record row := { direction : space; per_scale : R; fixed : R }.
Definition room (w : row) (s : R) : R := per_scale w * s - fixed w.
Definition holds (w : row) (s : R) (tau : space) : Prop := Rabs (dot (direction w) tau) <= room w s.

Section Rows.

Variables (s margin T_max : R) (rotors : list rotor).
(** The least f_max / b and the greatest f_min / b. *)
Variables (top bottom : R).

(** Both sides of a row divided by the length of its vector. *)
Definition normed (v : space) (scale_part fixed_part : R) : row :=
  {| direction := scaled (/ length v) v; per_scale := scale_part / length v; fixed := fixed_part / length v |}.
(** Two rotors at their ends at once. *)
Definition pair_row (r r' : rotor) : row := normed (sub (beta r) (beta r')) (top - bottom) (margin * 2).
(** The thrust floor and T_max. *)
Definition floor_row (r : rotor) : row := normed (beta r) (- bottom) (margin * 2 - T_max).

Hypothesis b_positive : forall r, In r rotors -> 0 < b r.
Hypothesis scale_nonneg : 0 <= s.
Hypothesis margin_nonneg : 0 <= margin.
Hypothesis top_least : forall r, In r rotors -> top <= greatest r / b r.
Hypothesis bottom_greatest : forall r, In r rotors -> least r / b r <= bottom.
(** A row without a direction is none of the code's: rotors that tilt alike, or
    one in the middle. They need only that some room is left. *)
Hypothesis room_left : 0 <= s * (top - bottom) - margin * 2 /\ 0 <= T_max - s * bottom - margin * 2.

Lemma normed_holds : forall v scale_part fixed_part tau, 0 <= scale_part * s - fixed_part ->
  (0 < length v -> holds (normed v scale_part fixed_part) s tau) ->
  Rabs (dot v tau) <= scale_part * s - fixed_part.
Proof.
  intros v a f tau Hroom H. destruct (Rle_lt_or_eq_dec 0 (length v) (length_nonneg v)) as [Hpos|Hzero].
  - specialize (H Hpos). unfold holds, room, normed in H. cbn [direction per_scale fixed] in H.
    replace (dot (scaled (/ length v) v) tau) with (/ length v * dot v tau) in H by (components; ring).
    rewrite Rabs_mult, (Rabs_pos_eq (/ length v)) in H by (left; now apply Rinv_0_lt_compat).
    apply Rmult_le_compat_l with (r := length v) in H; [|lra].
    replace (length v * (/ length v * Rabs (dot v tau))) with (Rabs (dot v tau)) in H by (field; lra).
    replace (length v * (a / length v * s - f / length v)) with (a * s - f) in H by (field; lra). exact H.
  - pose proof (cauchy_schwarz v tau) as Hc. rewrite <- Hzero, Rmult_0_l in Hc. lra.
Qed.

(** The rows suffice: N <= C. *)
Theorem rows_suffice : forall tau,
  (forall r r', In r rotors -> In r' rotors -> 0 < length (sub (beta r) (beta r')) -> holds (pair_row r r') s tau) ->
  (forall r, In r rotors -> 0 < length (beta r) -> holds (floor_row r) s tau) ->
  torque_fits s margin T_max rotors tau.
Proof.
  intros tau Hpair Hfloor. destruct room_left as (Hroom & Hlimit).
  assert (Hlow : forall r, In r rotors -> s * least r / b r <= s * bottom).
  { intros r Hr. unfold Rdiv. rewrite Rmult_assoc. now apply Rmult_le_compat_l, bottom_greatest. }
  assert (Hhigh : forall r, In r rotors -> s * top <= s * greatest r / b r).
  { intros r Hr. unfold Rdiv. rewrite Rmult_assoc. now apply Rmult_le_compat_l, top_least. }
  split.
  - intros r Hr. unfold needs. pose proof (Hlow r Hr).
    assert (Hn : 0 <= - bottom * s - (margin * 2 - T_max)) by lra.
    pose proof (both_sides _ _ (normed_holds (beta r) _ _ tau Hn (Hfloor r Hr))). lra.
  - intros r r' Hr Hr'. unfold needs, gives. pose proof (Hlow r Hr). pose proof (Hhigh r' Hr').
    assert (Hn : 0 <= (top - bottom) * s - margin * 2) by lra.
    pose proof (both_sides _ _ (normed_holds (sub (beta r') (beta r)) _ _ tau Hn (Hpair r' r Hr' Hr))) as H2.
    replace (dot (sub (beta r') (beta r)) tau) with (dot (beta r') tau - dot (beta r) tau) in H2
      by (components; ring). lra.
Qed.

End Rows.

(** The tick leaves rows out that two others imply, for every scale between two
    ends: w is a sum of theirs. *)
Theorem implied_row_holds : forall w a c of_a of_c s_lo s_hi s tau,
  direction w = add (scaled of_a (direction a)) (scaled of_c (direction c)) ->
  Rabs of_a * room a s_lo + Rabs of_c * room c s_lo <= room w s_lo ->
  Rabs of_a * room a s_hi + Rabs of_c * room c s_hi <= room w s_hi ->
  s_lo <= s <= s_hi -> holds a s tau -> holds c s tau -> holds w s tau.
Proof.
  intros w a c p q s_lo s_hi s tau E Hlo Hhi Hs Ha Hc. unfold holds in *.
  replace (dot (direction w) tau) with (p * dot (direction a) tau + q * dot (direction c) tau)
    by (rewrite E; components; ring).
  eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_mult.
  pose proof (Rmult_le_compat_l _ _ _ (Rabs_pos p) Ha). pose proof (Rmult_le_compat_l _ _ _ (Rabs_pos q) Hc).
  enough (Rabs p * room a s + Rabs q * room c s <= room w s) by lra.
  (* Both sides are linear in s. *)
  unfold room in *. destruct (Req_dec s_lo s_hi) as [->|Hne]; [replace s with s_hi by lra; exact Hhi|].
  assert (H1 := Rmult_le_compat_r (s_hi - s) _ _ ltac:(lra) Hlo).
  assert (H2 := Rmult_le_compat_r (s - s_lo) _ _ ltac:(lra) Hhi).
  apply Rmult_le_reg_r with (s_hi - s_lo); lra.
Qed.
