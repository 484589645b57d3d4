(** * A tick spends its torque part by part

    Section 4 of docs/extended-law.md, in exact arithmetic;
    controller-core/src/extended/budget.rs has [share] and [spend],
    controller-core/src/extended/controller/sections.rs the order of the parts.

    No theorem here asks how long a part is: bias, error, rates and the turn of
    the frame may be anything. *)

From Coq Require Import Reals Lra List.
From SaturatedHybrid Require Import Space Allocation.
Open Scope R_scope.

Section Spending.

(** The rows that a tick reads, the thrust scale, and a number above all rooms. *)
Variables (rows : list row) (s above : R).
Hypothesis unit_length : forall w, In w rows -> length (direction w) <= 1.

(** What fits in every direction. *)
Definition radius : R := fold_right (fun w least => Rmin least (room w s)) above rows.

(** The greatest share of [wanted], at most one, for which every row holds with
    [kept] to spare. A row that is beyond already admits only what brings it
    back. *)
Definition share (spent wanted : space) (kept : R) : R :=
  fold_right (fun w sigma =>
    let left := room w s - kept in
    let along := dot (direction w) spent in
    let more := dot (direction w) wanted in
    if Rle_dec (Rabs (along + more)) left then sigma
    else if Req_EM_T more 0 then sigma
    else Rmin sigma (Rmax (if Rlt_dec 0 more then left - along else left + along) 0 / Rabs more)) 1 rows.

(** The code asks first whether the whole is in the circle that fits. *)
Definition part_share (spent wanted : space) (kept : R) : R :=
  if Rlt_dec 0 (radius - kept) then
    if Rle_dec (square (add spent wanted)) ((radius - kept) * (radius - kept)) then 1 else share spent wanted kept
  else share spent wanted kept.
Definition spend (spent wanted : space) (kept : R) : space :=
  add spent (scaled (part_share spent wanted kept) wanted).

Lemma radius_below : forall w, In w rows -> radius <= room w s.
Proof.
  unfold radius. clear unit_length. induction rows as [|w' rest IH]; intros w H; [contradiction|]. cbn.
  destruct H as [<-|H]; [apply Rmin_r | eapply Rle_trans; [apply Rmin_l | now apply IH]].
Qed.

Lemma along_within : forall w v, In w rows -> Rabs (dot (direction w) v) <= length v.
Proof.
  intros w v Hw. eapply Rle_trans; [apply cauchy_schwarz|]. rewrite <- (Rmult_1_l (length v)) at 2.
  apply Rmult_le_compat_r; [apply length_nonneg | now apply unit_length].
Qed.

(** One row and its share. *)
Lemma one_row : forall left along more sigma, more <> 0 -> 0 <= sigma ->
  sigma <= Rmax (if Rlt_dec 0 more then left - along else left + along) 0 / Rabs more ->
  Rabs (along + sigma * more) <= Rmax (Rabs along) left.
Proof.
  intros left along more sigma Hne Hs H. assert (Hpos : 0 < Rabs more) by now apply Rabs_pos_lt.
  apply Rmult_le_compat_r with (r := Rabs more) in H; [|lra].
  unfold Rdiv in H. rewrite Rmult_assoc, Rinv_l, Rmult_1_r in H by lra.
  pose proof (Rmax_l (Rabs along) left). pose proof (Rmax_r (Rabs along) left). pose proof (Rabs_pos along).
  pose proof (both_sides along (Rabs along) (Rle_refl _)).
  assert (0 <= sigma * Rabs more) by (apply Rmult_le_pos; lra). apply Rabs_le.
  destruct (Rlt_dec 0 more) as [Hm|Hm].
  - rewrite (Rabs_pos_eq more) in * by lra. unfold Rmax in H. destruct (Rle_dec (left - along) 0); lra.
  - rewrite (Rabs_left more) in * by lra. unfold Rmax in H. destruct (Rle_dec (left + along) 0); lra.
Qed.

Lemma share_keeps : forall spent wanted kept, 0 <= share spent wanted kept <= 1 /\
  forall sigma w, 0 <= sigma <= share spent wanted kept -> In w rows ->
  Rabs (dot (direction w) (add spent (scaled sigma wanted)))
  <= Rmax (Rabs (dot (direction w) spent)) (room w s - kept).
Proof.
  intros spent wanted kept. unfold share. clear unit_length.
  induction rows as [|w' rest [[H0 H1] IH]]; cbn [fold_right].
  - split; [lra | intros; contradiction].
  - set (rest_share := fold_right _ 1 rest) in *. set (left := room w' s - kept).
    set (along := dot (direction w') spent). set (more := dot (direction w') wanted).
    assert (Heach : forall sigma, dot (direction w') (add spent (scaled sigma wanted)) = along + sigma * more)
      by (intros; unfold along, more; components; ring).
    destruct (Rle_dec (Rabs (along + more)) left) as [Hfits|Hbeyond]; [|destruct (Req_EM_T more 0) as [E|Hne]].
    + split; [lra|]. intros sigma w Hs [<-|Hw]; [|now apply IH]. rewrite Heach. fold along left.
      pose proof (both_sides _ _ Hfits). pose proof (both_sides along _ (Rle_refl _)).
      pose proof (Rmax_l (Rabs along) left). pose proof (Rmax_r (Rabs along) left). apply Rabs_le.
      destruct (Rle_dec 0 more).
      * assert (0 <= sigma * more <= 1 * more) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_r]; lra). lra.
      * assert (0 <= sigma * - more <= 1 * - more) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_r]; lra).
        lra.
    + split; [lra|]. intros sigma w Hs [<-|Hw]; [|now apply IH]. rewrite Heach, E. fold along.
      replace (along + sigma * 0) with along by ring. apply Rmax_l.
    + assert (0 < Rabs more) by now apply Rabs_pos_lt.
      set (most := Rmax _ 0 / Rabs more).
      assert (0 <= most) by (apply over_nonneg; [apply Rmax_r | assumption]). split.
      * split; [now apply Rmin_glb | eapply Rle_trans; [apply Rmin_l | exact H1]].
      * intros sigma w Hs [<-|Hw].
        -- rewrite Heach. apply one_row; [exact Hne | apply Hs | eapply Rle_trans; [apply Hs | apply Rmin_r]].
        -- apply IH; [|exact Hw]. split; [apply Hs | eapply Rle_trans; [apply Hs | apply Rmin_l]].
Qed.

Lemma part_share_between : forall spent wanted kept, 0 <= part_share spent wanted kept <= 1.
Proof.
  intros. destruct (share_keeps spent wanted kept) as [H _]. unfold part_share.
  destruct (Rlt_dec _ _); [|exact H]. destruct (Rle_dec _ _); [lra | exact H].
Qed.

(** Whatever is spent: a row is as far as it was, or has [kept] to spare. *)
Theorem row_after_spending : forall spent wanted kept w, In w rows ->
  Rabs (dot (direction w) (spend spent wanted kept)) <= Rmax (Rabs (dot (direction w) spent)) (room w s - kept).
Proof.
  intros spent wanted kept w Hw. unfold spend.
  destruct (share_keeps spent wanted kept) as [Hs H].
  assert (Hslow : Rabs (dot (direction w) (add spent (scaled (share spent wanted kept) wanted)))
    <= Rmax (Rabs (dot (direction w) spent)) (room w s - kept)) by (apply H; [lra | exact Hw]).
  unfold part_share. destruct (Rlt_dec 0 (radius - kept)) as [Hround|_]; [|exact Hslow].
  destruct (Rle_dec _ _) as [Hin|_]; [|exact Hslow].
  eapply Rle_trans; [|apply Rmax_r].
  replace (add spent (scaled 1 wanted)) with (add spent wanted) by (apply same; components; ring).
  eapply Rle_trans; [now apply along_within|]. pose proof (radius_below w Hw).
  apply Rle_trans with (radius - kept); [apply length_below; lra | lra].
Qed.

(** Every row with [kept] to spare. *)
Definition spares (spent : space) (kept : R) : Prop :=
  forall w, In w rows -> Rabs (dot (direction w) spent) <= room w s - kept.

(** What is kept stays: with [k] to spare and a part that keeps as much, there is
    [k] to spare. For zero: the rows hold after any part. *)
Theorem spares_after : forall spent wanted kept k, k <= kept -> spares spent k -> spares (spend spent wanted kept) k.
Proof.
  intros spent wanted kept k Hk H w Hw. eapply Rle_trans; [now apply row_after_spending|].
  apply Rmax_lub; [now apply H | lra].
Qed.

(** What is kept is there: as much of a part as is no longer. *)
Theorem kept_is_there : forall spent wanted kept k sigma, spares spent k -> 0 <= sigma <= 1 ->
  sigma * length wanted <= k - kept -> sigma <= part_share spent wanted kept.
Proof.
  intros spent wanted kept k sigma H Hs Hlength.
  assert (Hshare : sigma <= share spent wanted kept).
  { unfold share. assert (Heach : forall w, In w rows ->
      Rabs (dot (direction w) spent) + sigma * Rabs (dot (direction w) wanted) <= room w s - kept).
    { intros w Hw. pose proof (H w Hw). pose proof (along_within w wanted Hw).
      assert (sigma * Rabs (dot (direction w) wanted) <= sigma * length wanted) by (apply Rmult_le_compat_l; lra).
      lra. }
    clear H unit_length. induction rows as [|w rest IH]; cbn [fold_right]; [lra|].
    specialize (IH (fun w' Hw' => Heach w' (or_intror Hw'))). specialize (Heach w (or_introl eq_refl)).
    set (along := dot (direction w) spent) in *. set (more := dot (direction w) wanted) in *.
    destruct (Rle_dec _ _); [exact IH|]. destruct (Req_EM_T more 0) as [E|Hne]; [exact IH|].
    assert (0 < Rabs more) by now apply Rabs_pos_lt. apply Rmin_glb; [exact IH|].
    apply Rmult_le_reg_r with (Rabs more); [assumption|].
    unfold Rdiv. rewrite Rmult_assoc, Rinv_l, Rmult_1_r by lra.
    pose proof (both_sides along _ (Rle_refl _)). eapply Rle_trans; [|apply Rmax_l]. destruct (Rlt_dec 0 more); lra. }
  unfold part_share. destruct (Rlt_dec _ _); [|exact Hshare]. destruct (Rle_dec _ _); [lra | exact Hshare].
Qed.

(** While every row is within what it keeps, a part has a share: lambda is
    positive. *)
Theorem share_positive : forall spent wanted kept,
  (forall w, In w rows -> Rabs (dot (direction w) spent) < room w s - kept) -> 0 < part_share spent wanted kept.
Proof.
  intros spent wanted kept H.
  assert (Hshare : 0 < share spent wanted kept).
  { unfold share. clear unit_length. induction rows as [|w rest IH]; cbn [fold_right]; [lra|].
    specialize (IH (fun w' Hw' => H w' (or_intror Hw'))). specialize (H w (or_introl eq_refl)).
    set (along := dot (direction w) spent) in *. set (more := dot (direction w) wanted) in *.
    destruct (Rle_dec _ _); [exact IH|]. destruct (Req_EM_T more 0) as [E|Hne]; [exact IH|].
    assert (0 < Rabs more) by now apply Rabs_pos_lt. apply Rmin_glb_lt; [exact IH|].
    apply Rmult_lt_0_compat; [|now apply Rinv_0_lt_compat].
    assert (- Rabs along <= along <= Rabs along) by (apply both_sides; lra).
    eapply Rlt_le_trans; [|apply Rmax_l]. destruct (Rlt_dec 0 more); lra. }
  unfold part_share. destruct (Rlt_dec _ _); [|exact Hshare]. destruct (Rle_dec _ _); [lra | exact Hshare].
Qed.

(** ** A tick *)

Definition nothing : space := {| x := 0; y := 0; z := 0 |}.

(** The parts in their order; [kept] is J_max alpha_0. *)
Definition before_turning (bias pull gyro damping precession : space) (kept : R) : space :=
  let tilted := spend (spend nothing (scaled (-1) bias) 0) (scaled (-1) pull) kept in
  spend (spend (spend tilted gyro kept) (scaled (-1) damping) kept) precession kept.

(** The turn: as much of it as the floor admits, but no less than [always], which
    is alpha_0 over |q|; of that, what the rows admit. *)
Definition admitted (by_floor always : R) : R :=
  if Rlt_dec by_floor 1 then Rmax by_floor (Rmin always 1) else by_floor.
Definition turn_share (spent turn : space) (by_floor always : R) : R :=
  admitted by_floor always * part_share spent (scaled (admitted by_floor always) turn) 0.
Definition tick_torque (bias pull gyro damping precession turn : space) (kept by_floor always : R) : space :=
  spend (before_turning bias pull gyro damping precession kept) (scaled (admitted by_floor always) turn) 0.

Lemma nothing_spares : forall k, k <= radius -> spares nothing k.
Proof.
  intros k Hk w Hw. pose proof (radius_below w Hw).
  replace (dot (direction w) nothing) with 0 by (unfold nothing; components; ring). rewrite Rabs_R0. lra.
Qed.

(** Claim (d): for any parts the rows hold. *)
Theorem a_tick_keeps_the_rows : forall bias pull gyro damping precession turn kept by_floor always,
  0 <= radius -> 0 <= kept ->
  forall w, In w rows -> holds w s (tick_torque bias pull gyro damping precession turn kept by_floor always).
Proof.
  intros bias pull gyro damping precession turn kept by_floor always Hr Hk w Hw. unfold holds.
  rewrite <- (Rminus_0_r (room w s)). revert w Hw. unfold tick_torque, before_turning. cbv zeta.
  repeat (apply spares_after; [lra|]). now apply nothing_spares.
Qed.

(** By row D bias and reserve fit together: so the bias is spent whole, and the
    reserve is kept. *)
Theorem the_reserve_is_kept : forall bias pull gyro damping precession kept,
  length bias + kept <= radius -> 0 <= kept ->
  spend nothing (scaled (-1) bias) 0 = scaled (-1) bias
  /\ spares (before_turning bias pull gyro damping precession kept) kept.
Proof.
  intros bias pull gyro damping precession kept HD Hk.
  assert (Hlength : length (scaled (-1) bias) = length bias) by (rewrite length_scaled, Rabs_left by lra; ring).
  assert (Hwhole : part_share nothing (scaled (-1) bias) 0 = 1).
  { apply Rle_antisym; [apply part_share_between|].
    apply (kept_is_there _ _ _ radius); [now apply nothing_spares, Rle_refl | lra|]. rewrite Hlength. lra. }
  assert (Hbias : spend nothing (scaled (-1) bias) 0 = scaled (-1) bias)
    by (unfold spend; rewrite Hwhole; apply same; unfold nothing; components; ring).
  split; [exact Hbias|]. unfold before_turning. cbv zeta. rewrite Hbias.
  repeat (apply spares_after; [lra|]). intros w Hw. pose proof (radius_below w Hw).
  eapply Rle_trans; [now apply along_within|]. rewrite Hlength. lra.
Qed.

(** A pull of the error up to M = radius - |bias| - reserve is spent whole; where
    it is shorter than that, damping has a share, if there is no gyroscopic
    torque. *)
Theorem the_pull_is_whole : forall bias pull kept, 0 <= kept ->
  length pull <= radius - length bias - kept ->
  spend (scaled (-1) bias) (scaled (-1) pull) kept = scaled (-1) (add bias pull)
  /\ (length pull < radius - length bias - kept ->
      forall damping, 0 < part_share (scaled (-1) (add bias pull)) damping kept).
Proof.
  intros bias pull kept Hk H. pose proof (length_nonneg bias).
  assert (Hopposite : forall v, length (scaled (-1) v) = length v)
    by (intros; rewrite length_scaled, Rabs_left by lra; ring).
  split.
  - unfold spend. replace (part_share (scaled (-1) bias) (scaled (-1) pull) kept) with 1.
    + apply same; components; ring.
    + apply Rle_antisym; [|apply part_share_between].
      apply (kept_is_there _ _ _ (radius - length bias)); [|lra|].
      * intros w Hw. pose proof (radius_below w Hw). eapply Rle_trans; [now apply along_within|].
        rewrite Hopposite. lra.
      * rewrite Hopposite. lra.
  - intros Hless damping. apply share_positive. intros w Hw. pose proof (radius_below w Hw).
    eapply Rle_lt_trans; [now apply along_within|]. rewrite Hopposite. pose proof (triangle bias pull). lra.
Qed.

(** J (R~^T omega_rho')_12 is at most J_max |q| long: R~ keeps lengths, so a is as
    long as q. *)
Theorem torque_of_a_turn : forall j_1 j_2 j_max a q, 0 <= j_1 <= j_max -> 0 <= j_2 <= j_max -> 0 <= q ->
  square a <= q * q -> length {| x := j_1 * x a; y := j_2 * y a; z := 0 |} <= j_max * q.
Proof.
  intros j_1 j_2 j_max a q H1 H2 Hq Ha. apply length_below; [apply Rmult_le_pos; lra|].
  unfold square, dot in *. cbn.
  assert (Hj : forall j c, 0 <= j <= j_max -> j * c * (j * c) <= j_max * j_max * (c * c)).
  { intros j c Hj. replace (j * c * (j * c)) with (j * j * (c * c)) by ring.
    apply Rmult_le_compat_r; [apply squared | apply Rmult_le_compat; lra]. }
  pose proof (Hj j_1 (x a) H1). pose proof (Hj j_2 (y a) H2).
  pose proof (Rmult_le_pos _ _ (squared j_max) (squared (z a))).
  pose proof (Rmult_le_compat_l (j_max * j_max) _ _ (squared j_max) Ha). lra.
Qed.

(** So a turn is never shortened below alpha_0, whatever floor and rows say: with
    |q| <= alpha_0 its share is one. *)
Theorem a_turn_keeps_the_reserve : forall spent turn j_max alpha_0 q by_floor sigma,
  spares spent (j_max * alpha_0) -> length turn <= j_max * q -> 0 <= j_max -> 0 < q ->
  0 <= by_floor <= 1 -> 0 <= sigma <= 1 -> sigma <= alpha_0 / q ->
  sigma <= turn_share spent turn by_floor (alpha_0 / q) <= 1.
Proof.
  intros spent turn j_max alpha_0 q by_floor sigma H Hturn Hj Hq Hf Hs Hsq. unfold turn_share.
  set (first := admitted by_floor (alpha_0 / q)).
  assert (Hfirst : sigma <= first <= 1 /\ 0 <= first).
  { unfold first, admitted. pose proof (Rmax_l by_floor (Rmin (alpha_0 / q) 1)).
    pose proof (Rmin_r (alpha_0 / q) 1). pose proof (Rmin_glb _ _ _ Hsq (proj2 Hs)).
    pose proof (Rmax_r by_floor (Rmin (alpha_0 / q) 1)).
    pose proof (Rmax_lub by_floor (Rmin (alpha_0 / q) 1) 1). destruct (Rlt_dec by_floor 1); lra. }
  pose proof (part_share_between spent (scaled first turn) 0) as Hp. split.
  - destruct (Req_dec sigma 0) as [->|Hne]; [apply Rmult_le_pos; lra|].
    assert (Hshare : sigma / first <= part_share spent (scaled first turn) 0).
    { apply (kept_is_there _ _ _ (j_max * alpha_0)); [exact H | |].
      - split; [apply over_nonneg; lra|]. apply Rmult_le_reg_r with first; [lra|].
        replace (sigma / first * first) with sigma by (field; lra). lra.
      - rewrite length_scaled, Rabs_pos_eq by lra. replace (sigma / first * (first * length turn)) with
          (sigma * length turn) by (field; lra).
        apply Rle_trans with (alpha_0 / q * (j_max * q)); [|right; field; lra].
        apply Rmult_le_compat; try lra; try apply length_nonneg. }
    apply Rmult_le_compat_l with (r := first) in Hshare; [|lra].
    replace (first * (sigma / first)) with sigma in Hshare by (field; lra). exact Hshare.
  - rewrite <- (Rmult_1_r 1). apply Rmult_le_compat; lra.
Qed.

End Spending.

(** ** Put together: no tick takes a rotor out of its range

    Whatever bias, error, rates, damping, turn, thrust and yaw torque are. The
    tick's rows imply those of the limits and of the rotors; rotors share a thrust
    but cancel in a torque. *)

Theorem a_tick_keeps_rotors_in_range :
  forall rows s above margin T_max yaw_max rotors top bottom limits bias pull gyro damping precession turn kept
    by_floor always braking wanted wanted_yaw,
  (forall w, In w rows -> length (direction w) <= 1) ->
  (forall r, In r rotors -> 0 < b r /\ top <= greatest r / b r /\ least r / b r <= bottom /\ 0 <= least r) ->
  total rotors b = 1 -> (forall tau, total rotors (fun r => b r * dot (beta r) tau) = 0) ->
  0 <= s -> 0 <= margin -> 0 <= yaw_max -> 0 <= kept ->
  0 <= radius rows s above -> 0 <= s * (top - bottom) - margin * 2 -> 0 <= T_max - s * bottom - margin * 2 ->
  (forall tau, (forall w, In w rows -> holds w s tau) ->
    (forall w, In w limits -> holds w s tau)
    /\ (forall r r', In r rotors -> In r' rotors -> 0 < length (sub (beta r) (beta r')) ->
        holds (pair_row margin top bottom r r') s tau)
    /\ (forall r, In r rotors -> 0 < length (beta r) -> holds (floor_row margin T_max bottom r) s tau)) ->
  let tau := tick_torque rows s above bias pull gyro damping precession turn kept by_floor always in
  let T := thrust s margin T_max rotors tau braking wanted in
  let tau_z := yaw s margin yaw_max rotors tau T wanted_yaw in
  (forall w, In w limits -> holds w s tau) /\ T <= T_max /\ Rabs tau_z <= yaw_max
  /\ forall r, In r rotors ->
     s * least r + b r * margin <= command r T tau tau_z <= s * greatest r - b r * margin.
Proof.
  intros rows s above margin T_max yaw_max rotors top bottom limits bias pull gyro damping precession turn kept
    by_floor always braking wanted wanted_yaw Hunit Hrotors Hone Hzero Hs Hmargin Hyaw Hkept Hradius Hroom Hfloor Himplied
    tau T tau_z.
  assert (Hrows : forall w, In w rows -> holds w s tau) by now apply a_tick_keeps_the_rows.
  destruct (Himplied tau Hrows) as (Hlimits & Hpairs & Hfloors).
  assert (Hfits : torque_fits s margin T_max rotors tau).
  { apply (rows_suffice s margin T_max rotors top bottom); try assumption; try (intros r Hr; apply (Hrotors r Hr)).
    split; assumption. }
  destruct (rotors_within_range s margin T_max yaw_max rotors tau (fun r Hr => proj1 (Hrotors r Hr)) Hfits
    (fun r Hr => Rmult_le_pos _ _ Hs (proj2 (proj2 (proj2 (Hrotors r Hr))))) Hone (Hzero tau) braking wanted wanted_yaw
    Hyaw) as (Hall & HT & Hz).
  repeat split; try assumption; now apply Hall.
Qed.
